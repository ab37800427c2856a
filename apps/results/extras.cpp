#include "apps/results/extras.h"

#include "apps/results/moments_table.h"
#include "core/error.h"
#include "flatland/scene/frequency_shift.h"
#include "mc/changes/frequency_shifts.h"
#include "mc/slab/slab_covariance.h"
#include "mc/space/space_scene.h"
#include "wave_solver/solutions/ensemble.h"

namespace flatspeckle::apps {

namespace {

void require_plane_waves(const std::string& key, const CovarianceRequest& request) {
  using Kind = CovarianceRequest::Kind;
  if (!request.lights.all(Light::Kind::plane) || request.kind == Kind::tilt_shift)
    throw InputError(key + ": needs plane waves, and no tilt_shift");
}

ExtendedEstimation with_gradient(const Scene& scene, const mc::GradientJob& job,
                                 const std::string& plan) {
  std::string text = plan + "; derivatives by";
  for (const auto& parameter : job.parameters) text += ' ' + parameter;
  return {{job.field, text}, [scene, job](ResultFile& file, const GroupedSums& sums) {
            const auto gradient = mc::gradient_estimates(scene, sums, job);
            print_gradient(scene.request, job, gradient);
            mc::write_gradient(file, scene.request, job, gradient);
          }};
}

ExtendedEstimation mc_gradient(const Scene& scene, mc::ReversedPaths reversed, std::uint64_t seed) {
  require_plane_waves("gradient", scene.request);
  const auto plan = mc::gradient_plan(scene, reversed);
  return with_gradient(scene, mc::gradient_job(scene, plan, seed), "mc: " + plan.describe());
}

ExtendedEstimation transport_gradient(const Scene& scene, mc::ReversedPaths reversed,
                                      double tolerance) {
  mc::check_gradient(scene);
  const bool with_reversed = mc::make_plan(scene, reversed).reversed;
  const auto job = scene.medium.dimension == 3 ? mc::space_gradient_job : mc::slab_gradient_job;
  return with_gradient(scene, job(scene, with_reversed, {tolerance}),
                       transport_estimation(scene, reversed, tolerance).plan);
}

ExtendedEstimation with_delays(const Scene& scene, const mc::PathJob& job,
                               const std::vector<double>& delays, const std::string& plan) {
  return {{job.field, plan + "; scatterers diffuse"},
          [scene, job, delays](ResultFile& file, const GroupedSums& sums) {
            const auto found = mc::change_estimates(scene.request, job, sums);
            print_changes(scene.request, "delay", delays, found.correlation);
            mc::write_delays(file, scene, delays, found);
          }};
}

ExtendedEstimation mc_delays(const Scene& scene, mc::ReversedPaths reversed,
                             const std::vector<double>& delays, std::uint64_t seed) {
  require_plane_waves("delays", scene.request);
  const auto plan = mc::make_plan(scene, reversed);
  return with_delays(scene, mc::delay_job(scene, plan, delays, seed), delays,
                     "mc: " + plan.describe());
}

mc::PathJob change_job(const Scene& scene, mc::ReversedPaths reversed,
                       const std::vector<mc::FieldChange>& changes, double tolerance) {
  const bool with_reversed = mc::make_plan(scene, reversed).reversed;
  const auto job = scene.medium.dimension == 3 ? mc::space_change_job : mc::slab_change_job;
  return job(scene, with_reversed, {tolerance}, changes);
}

ExtendedEstimation transport_delays(const Scene& scene, mc::ReversedPaths reversed,
                                    const std::vector<double>& delays, double tolerance) {
  mc::check_delays(scene, delays);
  require_changing("delays", scene.request);
  std::vector<mc::FieldChange> changes;
  for (const double delay : delays) changes.push_back({.delay = delay});
  return with_delays(scene, change_job(scene, reversed, changes, tolerance), delays,
                     transport_estimation(scene, reversed, tolerance).plan);
}

ExtendedEstimation with_frequency_shifts(const Scene& scene, const std::vector<double>& shifts,
                                         const ChangeEstimation& changes) {
  return {{changes.job.field, changes.plan + "; two frequencies"},
          [=](ResultFile& file, const GroupedSums& sums) {
            const auto found = mc::change_estimates(scene.request, changes.job, sums);
            print_changes(scene.request, "shift", shifts, found.correlation);
            mc::write_shift_axis(file, shifts);
            mc::write_frequency_shifts(file, "", scene, shifts, found);
          }};
}

}  // namespace

void add_frequency_key(Keys& keys, std::vector<double>& shifts) {
  keys.group("Methods");
  keys.add("frequency_shifts", shifts,
           "Also the field's correlation with that at shifted frequencies, relative to its own");
}

void add_extra_keys(Keys& keys, Extras& extras) {
  keys.group("Methods");
  keys.add("gradient", extras.gradient,
           "Also derivatives of the covariance by mu_t, g, albedo and optical depth; by transport "
           "of cylinders and spheres by radius and index too")
      .only_of("method = mc or transport");
  keys.add("delays", extras.delays,
           "Also the field's correlation after delays, as the scatterers diffuse: k^2 D tau")
      .not_negative()
      .only_of("method = mc or transport");
  add_frequency_key(keys, extras.frequency_shifts);
}

void read_extras(const Keys& keys, const Extras& extras, const std::string& method) {
  const bool shifts = !keys.read(extras.frequency_shifts).empty();
  if (method == "wave") return;
  const bool delays = !keys.read(extras.delays).empty(), gradient = keys.read(extras.gradient);
  if (gradient && delays) throw InputError("gradient, delays: give one of them");
  if (shifts && (gradient || delays))
    throw InputError("gradient, delays, frequency_shifts: give one of them");
}

ChangeEstimation mc_frequencies(const Scene& scene, mc::ReversedPaths reversed,
                                const std::vector<double>& shifts, std::uint64_t seed) {
  check_frequency_shifts(scene.request, shifts);
  const auto plan = mc::frequency_plan(scene, reversed);
  return {mc::frequency_job(scene, plan, shifts, seed), "mc: " + plan.describe()};
}

ChangeEstimation transport_frequencies(const Scene& scene, mc::ReversedPaths reversed,
                                       const std::vector<double>& shifts, double tolerance) {
  check_frequency_shifts(scene.request, shifts);
  std::vector<mc::FieldChange> changes;
  for (const double shift : shifts) changes.push_back({.shift = shift});
  return {change_job(scene, reversed, changes, tolerance),
          transport_estimation(scene, reversed, tolerance).plan};
}

ChangeEstimation wave_frequencies(const Scene& scene, const std::vector<double>& shifts,
                                  double tolerance, std::uint64_t seed) {
  check_frequency_shifts(scene.request, shifts);
  const auto [field, all] = wave::frequency_job(scene, shifts, seed, tolerance);
  return {{field, all, scene.request.entries.size()}, wave_plan(scene, tolerance)};
}

ExtendedEstimation extended_estimation(const Scene& scene, mc::ReversedPaths reversed,
                                       const Extras& extras, std::uint64_t seed) {
  if (extras.gradient) return mc_gradient(scene, reversed, seed);
  if (!extras.delays.empty()) return mc_delays(scene, reversed, extras.delays, seed);
  if (const auto& shifts = extras.frequency_shifts; !shifts.empty())
    return with_frequency_shifts(scene, shifts, mc_frequencies(scene, reversed, shifts, seed));
  return {mc_estimation(scene, reversed, seed), {}};
}

ExtendedEstimation extended_transport(const Scene& scene, mc::ReversedPaths reversed,
                                      const Extras& extras, double tolerance) {
  if (extras.gradient) return transport_gradient(scene, reversed, tolerance);
  if (!extras.delays.empty()) return transport_delays(scene, reversed, extras.delays, tolerance);
  if (const auto& shifts = extras.frequency_shifts; !shifts.empty())
    return with_frequency_shifts(scene, shifts,
                                 transport_frequencies(scene, reversed, shifts, tolerance));
  return {transport_estimation(scene, reversed, tolerance), {}};
}

ExtendedEstimation extended_waves(const Scene& scene, const Extras& extras, double tolerance,
                                  std::uint64_t seed) {
  if (const auto& shifts = extras.frequency_shifts; !shifts.empty())
    return with_frequency_shifts(scene, shifts, wave_frequencies(scene, shifts, tolerance, seed));
  return {wave_estimation(scene, tolerance, seed), {}};
}

}  // namespace flatspeckle::apps
