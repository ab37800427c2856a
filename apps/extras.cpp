#include "apps/extras.h"

#include "apps/moments_table.h"
#include "core/error.h"
#include "mc/transport/slab_covariance.h"

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
  return with_gradient(scene, mc::slab_gradient_job(scene, with_reversed, {tolerance}),
                       transport_estimation(scene, reversed, tolerance).plan);
}

ExtendedEstimation with_delays(const Scene& scene, const mc::PathJob& job,
                               const std::vector<double>& delays, const std::string& plan) {
  return {{job.field, plan + "; scatterers diffuse"},
          [scene, job, delays](ResultFile& file, const GroupedSums& sums) {
            const auto found = mc::delay_estimates(scene.request, job, sums);
            print_delays(scene.request, delays, found.correlation);
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

ExtendedEstimation transport_delays(const Scene& scene, mc::ReversedPaths reversed,
                                    const std::vector<double>& delays, double tolerance) {
  using Kind = CovarianceRequest::Kind;
  if (scene.request.kind != Kind::intensity && scene.request.kind != Kind::memory_effect)
    throw InputError("delays: needs covariance = intensity or memory_effect");
  mc::check_delays(scene, delays);
  const bool with_reversed = mc::make_plan(scene, reversed).reversed;
  return with_delays(scene, mc::slab_delay_job(scene, with_reversed, {tolerance}, delays), delays,
                     transport_estimation(scene, reversed, tolerance).plan);
}

}  // namespace

void add_extra_keys(Keys& keys, Extras& extras) {
  keys.group("Methods");
  keys.add("gradient", extras.gradient,
           "Also derivatives of the covariance by mu_t, g, albedo and optical depth")
      .only_of("method = mc or transport");
  keys.add("delays", extras.delays,
           "Also the field's correlation after delays, as the scatterers diffuse: k^2 D tau")
      .not_negative()
      .only_of("method = mc or transport");
}

void read_extras(const Keys& keys, const Extras& extras) {
  const bool delays = !keys.read(extras.delays).empty();
  if (keys.read(extras.gradient) && delays) throw InputError("gradient, delays: give one of them");
}

ExtendedEstimation extended_estimation(const Scene& scene, mc::ReversedPaths reversed,
                                       const Extras& extras, std::uint64_t seed) {
  if (extras.gradient) return mc_gradient(scene, reversed, seed);
  if (!extras.delays.empty()) return mc_delays(scene, reversed, extras.delays, seed);
  return {mc_estimation(scene, reversed, seed), {}};
}

ExtendedEstimation extended_transport(const Scene& scene, mc::ReversedPaths reversed,
                                      const Extras& extras, double tolerance) {
  if (extras.gradient) return transport_gradient(scene, reversed, tolerance);
  if (!extras.delays.empty()) return transport_delays(scene, reversed, extras.delays, tolerance);
  return {transport_estimation(scene, reversed, tolerance), {}};
}

}  // namespace flatspeckle::apps
