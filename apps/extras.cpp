#include "apps/extras.h"

#include "apps/moments_table.h"
#include "core/error.h"

namespace flatspeckle::apps {

namespace {

void require_plane_waves(const std::string& key, const CovarianceRequest& request) {
  using Kind = CovarianceRequest::Kind;
  if (!request.lights.all(Light::Kind::plane) || request.kind == Kind::tilt_shift)
    throw InputError(key + ": needs plane waves, and no tilt_shift");
}

ExtendedEstimation with_gradient(const Scene& scene, const MethodSettings& settings,
                                 std::uint64_t seed) {
  require_plane_waves("gradient", scene.request);
  const auto plan = mc::gradient_plan(scene, reversed_paths(settings));
  const auto job = mc::gradient_job(scene, plan, seed);
  std::string text = "mc: " + plan.describe() + "; derivatives by";
  for (const auto& parameter : job.parameters) text += ' ' + parameter;
  return {{job.field, text}, [scene, job](ResultFile& file, const GroupedSums& sums) {
            const auto gradient = mc::gradient_estimates(scene, sums, job);
            print_gradient(scene.request, job, gradient);
            mc::write_gradient(file, scene.request, job, gradient);
          }};
}

ExtendedEstimation with_delays(const Scene& scene, const MethodSettings& settings,
                               const std::vector<double>& delays, std::uint64_t seed) {
  require_plane_waves("delays", scene.request);
  const auto plan = mc::make_plan(scene, reversed_paths(settings));
  const auto job = mc::delay_job(scene, plan, delays, seed);
  return {{job.field, "mc: " + plan.describe() + "; scatterers diffuse"},
          [scene, job, delays](ResultFile& file, const GroupedSums& sums) {
            const auto found = mc::delay_estimates(job, sums);
            print_delays(scene.request, delays, found.correlation);
            mc::write_delays(file, scene, delays, found);
          }};
}

}  // namespace

void add_extra_options(Options& options, Extras& extras) {
  options.add_flag("--gradient", extras.gradient,
                   "Also derivatives of the covariance by mu_t, g, albedo and optical depth");
  options.add("--delays", extras.delays,
              "Also the field's correlation after delays, as the scatterers diffuse: k^2 D tau");
}

ExtendedEstimation extended_estimation(const Scene& scene, const MethodSettings& settings,
                                       const Extras& extras, std::uint64_t seed) {
  if (extras.gradient && !extras.delays.empty())
    throw InputError("gradient, delays: give one of them");
  if (!extras.gradient && extras.delays.empty()) return {mc_estimation(scene, settings, seed), {}};
  return extras.gradient ? with_gradient(scene, settings, seed)
                         : with_delays(scene, settings, extras.delays, seed);
}

void refuse_extras(const Extras& extras) {
  if (extras.gradient || !extras.delays.empty())
    throw InputError(std::string(extras.gradient ? "gradient" : "delays") + ": needs method = mc");
}

}  // namespace flatspeckle::apps
