#include "apps/results/extras.h"

#include "apps/results/moments_table.h"
#include "core/error.h"
#include "flatland/scene/frequency_shift.h"
#include "mc/paths/dynamics/frequency_shifts.h"
#include "mc/paths/layers/layer_gradient.h"
#include "mc/slab/slab_jobs.h"
#include "wave_solver/solutions/ensemble.h"

namespace flatspeckle::apps {

namespace {

void refuse_layers(const Scene& scene, const std::string& key) {
  if (scene.profile)
    throw InputError("method", "transport",
                     "does not support " + key + " with layers: use method = mc");
}

void require_plane_waves(const std::string& key, const CovarianceRequest& request) {
  using Kind = CovarianceRequest::Kind;
  if (!request.lights.all(Light::Kind::plane) || request.kind == Kind::tilt_shift)
    throw InputError(key + ": requires plane waves and a covariance other than tilt_shift");
}

Estimation with_gradient(const Scene& scene, const mc::GradientJob& job, const std::string& plan) {
  std::string text = plan + "; derivatives by";
  for (const auto& parameter : job.parameters) text += ' ' + parameter;
  return {job.field, text, [scene, job](ResultFile& file, const GroupedSums& sums) {
            const auto gradient = mc::gradient_estimates(scene, sums, job);
            print_gradient(scene.request, job, gradient);
            mc::write_gradient(file, scene.request, job, gradient);
          }};
}

Estimation mc_gradient(const Scene& scene, mc::ReversedPaths reversed, std::uint64_t seed) {
  require_plane_waves("gradient", scene.request);
  const auto plan = mc::gradient_plan(scene, reversed);
  const auto job = scene.profile ? mc::layer_gradient_job(scene, plan, seed)
                                 : mc::gradient_job(scene, plan, seed);
  return with_gradient(scene, job, "mc: " + plan.describe());
}

Estimation transport_gradient(const Scene& scene, mc::ReversedPaths reversed, double tolerance) {
  refuse_layers(scene, "gradient");
  mc::check_gradient(scene);
  const bool with_reversed = mc::make_plan(scene, reversed).reversed;
  return with_gradient(scene, mc::slab_gradient_job(scene, with_reversed, {tolerance}),
                       transport_estimation(scene, reversed, tolerance).plan);
}

mc::Motion motion_of(const Extras& extras) {
  mc::Motion motion;
  if (!extras.velocity.empty()) motion.velocity = {extras.velocity[0], extras.velocity[1]};
  motion.diffusion = extras.diffusion.value_or(1);
  motion.shear = extras.shear.value_or(0);
  return motion;
}

Estimation with_delays(const Scene& scene, const mc::PathJob& job, const Extras& extras,
                       const std::string& plan) {
  const mc::Motion motion = motion_of(extras);
  const std::string moves = motion.only_diffuses(scene) ? "diffuse" : "diffuse and flow";
  return {job.field, plan + "; scatterers " + moves,
          [scene, job, extras, motion](ResultFile& file, const GroupedSums& sums) {
            const auto found = mc::change_estimates(scene.request, job, sums);
            print_changes(scene.request, "delay", extras.delays, found.correlation);
            mc::write_delays(file, scene, extras.delays, found, motion);
            if (extras.exposure.times.empty()) return;
            const auto contrast =
                mc::squared_contrast(scene.request, job, sums, extras.delays, extras.exposure);
            print_changes(scene.request, "exposure", extras.exposure.times, contrast, "K^2");
            mc::write_contrast(file, extras.exposure, contrast);
          }};
}

Estimation mc_delays(const Scene& scene, mc::ReversedPaths reversed, const Extras& extras,
                     std::uint64_t seed) {
  require_plane_waves("delays", scene.request);
  mc::check_exposure(extras.exposure, extras.delays);
  const auto plan = mc::make_plan(scene, reversed);
  return with_delays(scene, mc::delay_job(scene, plan, extras.delays, seed, motion_of(extras)),
                     extras, "mc: " + plan.describe());
}

mc::PathJob change_job(const Scene& scene, mc::ReversedPaths reversed,
                       const std::vector<mc::FieldChange>& changes, double tolerance) {
  const bool with_reversed = mc::make_plan(scene, reversed).reversed;
  return mc::slab_change_job(scene, with_reversed, {tolerance}, changes);
}

Estimation transport_delays(const Scene& scene, mc::ReversedPaths reversed, const Extras& extras,
                            double tolerance) {
  mc::check_delays(scene, extras.delays);
  require_changing("delays", scene.request);
  const mc::Motion motion = motion_of(extras);
  if (motion.velocity != Vec2{} || motion.shear != 0)
    throw InputError("velocity, shear: require method = mc");
  if (scene.request.has_reference() && !extras.exposure.times.empty())
    throw InputError("exposures: require covariance = intensity");
  mc::check_exposure(extras.exposure, extras.delays);
  std::vector<mc::FieldChange> changes;
  for (const double delay : extras.delays) changes.push_back({.delay = motion.diffusion * delay});
  return with_delays(scene, change_job(scene, reversed, changes, tolerance), extras,
                     transport_estimation(scene, reversed, tolerance).plan);
}

Estimation with_frequency_shifts(const Scene& scene, const std::vector<double>& shifts,
                                 const ChangeEstimation& changes) {
  return {changes.job.field, changes.plan + "; two frequencies",
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
           "Also estimate the correlation of the field with the field at shifted frequencies; "
           "shifts are relative to the frequency");
}

void add_extra_keys(Keys& keys, Extras& extras) {
  keys.group("Methods");
  keys.add(
          "gradient", extras.gradient,
          "Also estimate derivatives of the covariance with respect to mu_t, g, albedo and optical "
          "depth; with transport, for cylinders and spheres, also with respect to radius and index")
      .only_of("method = mc or transport");
  keys.add("delays", extras.delays,
           "Also estimate the field correlation after these delays tau, during which the "
           "scatterers diffuse; given as k^2 D tau, or in units of time if diffusion is given")
      .not_negative()
      .only_of("method = mc or transport");
  keys.add("diffusion", extras.diffusion, "k^2 D of the scatterers per unit of delay (default: 1)")
      .not_negative()
      .only_of("delays");
  keys.add("velocity", extras.velocity,
           "Velocity of the scatterers, v_x and v_z, in lengths per unit of delay")
      .exactly(2, "v_x, v_z")
      .unit("length")
      .only_of("delays by method = mc");
  keys.add("shear", extras.shear, "Velocity gradient: increase of v_x per unit of depth")
      .only_of("delays by method = mc");
  keys.add("exposures", extras.exposure.times,
           "Also estimate the squared speckle contrast K^2 for these exposure times, in units of "
           "the delays, up to the longest delay")
      .positive()
      .only_of("delays");
  keys.add("beta", extras.exposure.beta, "Squared speckle contrast K^2 of static scatterers")
      .positive_to(1)
      .only_of("exposures");
  add_frequency_key(keys, extras.frequency_shifts);
}

namespace {

void read_motion(const Keys& keys, const Extras& extras) {
  keys.read(extras.diffusion);
  keys.read(extras.velocity);
  keys.read(extras.shear);
  if (!keys.read(extras.exposure.times).empty()) keys.read(extras.exposure.beta);
}

}  // namespace

void read_extras(const Keys& keys, const Extras& extras, const std::string& method) {
  const bool shifts = !keys.read(extras.frequency_shifts).empty();
  if (method == "wave") return;
  if (!keys.read(extras.delays).empty()) read_motion(keys, extras);
  const bool delays = !extras.delays.empty(), gradient = keys.read(extras.gradient);
  if (gradient && delays) throw InputError("gradient, delays: give only one of them");
  if (shifts && (gradient || delays))
    throw InputError("gradient, delays, frequency_shifts: give only one of them");
}

ChangeEstimation mc_frequencies(const Scene& scene, mc::ReversedPaths reversed,
                                const std::vector<double>& shifts, std::uint64_t seed) {
  check_frequency_shifts(scene.request, shifts);
  const auto plan = mc::frequency_plan(scene, reversed);
  return {mc::frequency_job(scene, plan, shifts, seed), "mc: " + plan.describe()};
}

ChangeEstimation transport_frequencies(const Scene& scene, mc::ReversedPaths reversed,
                                       const std::vector<double>& shifts, double tolerance) {
  refuse_layers(scene, "frequency_shifts");
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

Estimation extended_estimation(const Scene& scene, mc::ReversedPaths reversed, const Extras& extras,
                               std::uint64_t seed) {
  if (extras.gradient) return mc_gradient(scene, reversed, seed);
  if (!extras.delays.empty()) return mc_delays(scene, reversed, extras, seed);
  if (const auto& shifts = extras.frequency_shifts; !shifts.empty())
    return with_frequency_shifts(scene, shifts, mc_frequencies(scene, reversed, shifts, seed));
  return mc_estimation(scene, reversed, seed);
}

Estimation extended_transport(const Scene& scene, mc::ReversedPaths reversed, const Extras& extras,
                              double tolerance) {
  if (extras.gradient) return transport_gradient(scene, reversed, tolerance);
  if (!extras.delays.empty()) return transport_delays(scene, reversed, extras, tolerance);
  if (const auto& shifts = extras.frequency_shifts; !shifts.empty())
    return with_frequency_shifts(scene, shifts,
                                 transport_frequencies(scene, reversed, shifts, tolerance));
  return transport_estimation(scene, reversed, tolerance);
}

Estimation extended_waves(const Scene& scene, const Extras& extras, double tolerance,
                          std::uint64_t seed) {
  if (const auto& shifts = extras.frequency_shifts; !shifts.empty())
    return with_frequency_shifts(scene, shifts, wave_frequencies(scene, shifts, tolerance, seed));
  return wave_estimation(scene, tolerance, seed);
}

}  // namespace flatspeckle::apps
