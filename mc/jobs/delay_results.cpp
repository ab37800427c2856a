#include "mc/jobs/delay_results.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "core/error.h"
#include "core/result/result_group.h"
#include "mc/theory/diffusing_waves.h"

namespace flatspeckle::mc {

void check_delays(const Scene& scene, const std::vector<double>& delays, const Motion& motion) {
  if (!scene.medium.structure.independent())
    throw InputError(
        "delays: requires independent positions of the scatterers, without a structure factor");
  for (const double delay : delays)
    if (!(delay >= 0 && delay <= 1e100))
      throw InputError("delays", delay, "must not be negative, and at most 1e100");
  if (!scene.profile || motion.velocity != Vec{} || motion.shear != 0) return;
  for (const Material& material : scene.profile->materials())
    if (material.motion.velocity != 1)
      throw InputError(
          "layers: column flow requires velocity; the factor on the diffusion constant is column "
          "diffusion");
}

DelayEstimates delay_estimates(const CovarianceRequest& request, const PathJob& job,
                               const GroupedSums& sums, const Dynamics& dynamics) {
  DelayEstimates found{change_estimates(request, job, sums), {}, {}};
  if (request.has_reference()) return found;
  const std::size_t channels = request.entries.size(), delays = dynamics.delays.size();
  found.intensity = jackknife(sums, [&](double samples, std::span<const Complex> total) {
    const std::vector<Complex> all = job.all(samples, total);
    std::vector<Complex> values(delays * channels);
    for (std::size_t c = 0; c < channels; ++c) {
      const auto squares = squared_correlation(all, channels, c);
      for (std::size_t t = 0; t < delays; ++t)
        values[t * channels + c] = dynamics.exposure.beta * squares[t];
    }
    return values;
  });
  found.decay = crossings(request, job, sums, dynamics.delays, std::exp(-2));
  return found;
}

const DatasetTable delays_table{
    "delays",
    {{"delay", Data::scale, "", "DELAY",
      "delay tau in s if the diffusion constant is given in m^2/s, otherwise k^2 D tau or tau in "
      "the unit of time of the key diffusion"},
     {"covariance", Data::estimate, "delay LIGHT VIEW", "COVARIANCE",
      "covariance of the field with itself after a delay"},
     {"field_correlation", Data::estimate, "delay LIGHT VIEW", "1",
      "field correlation after a delay, |g1|"},
     {"intensity_correlation", Data::estimate, "delay LIGHT VIEW", "1",
      "correlation of intensities after a delay, g2 - 1 = beta |g1|^2"},
     {"decay_time", Data::estimate, "LIGHT VIEW", "DELAY", "delay at which |g1| falls to 1/e"},
     {"decay_time_censored", Data::count, "LIGHT VIEW", "1", crossing_meaning},
     {"complex_covariance", Data::complex_estimate, "delay LIGHT VIEW", "COVARIANCE",
      "covariance of the field with itself after a delay, where scatterers flow"},
     {"complex_correlation", Data::complex_estimate, "delay LIGHT VIEW", "1",
      "field correlation after a delay, g1, where scatterers flow"},
     {"diffusion_theory", Data::real, "delay", "1",
      "field correlation of transmitted light in diffusion theory"},
     {"reflected_diffusion_theory", Data::real, "delay", "1",
      "field correlation of reflected light in diffusion theory"},
     {"delayed_covariance", Data::complex_estimate, "delay tilt VIEW", "COVARIANCE",
      "covariance of reference and moved field after a delay"},
     {"delayed_correlation", Data::estimate, "delay tilt", "1",
      "C_E of reference and moved field after a delay"}},
    {{"delay", "k2_diffusion", "float64",
      "k^2 D per unit of delay: delay times k2_diffusion is k^2 D tau"},
     {"delay", "diffusion", "float64", "diffusion constant D in m^2/s, if delays are in s"},
     {"intensity_correlation", "beta", "float64", "coherence factor, g2 - 1 at delay 0"}},
    {{"DELAY", {"1", "s"}}}};

namespace {

/// Writes the field correlation of diffusion theory for each side of the slab that has a view.
void write_theory(const ResultGroup& root, const Scene& scene, const Dynamics& dynamics) {
  const auto write = [&](const std::string& name, ExitSide side) {
    const bool is_seen = std::ranges::any_of(scene.request.views, [&](const View& view) {
      return (std::cos(view.angle) > 0) == (side == ExitSide::transmitted);
    });
    if (is_seen)
      root.put(name, column(dynamics.delays, [&](double delay) {
                 return diffusing_wave_correlation(scene, dynamics.motion.diffusion * delay, side);
               }));
  };
  write("diffusion_theory", ExitSide::transmitted);
  write("reflected_diffusion_theory", ExitSide::reflected);
}

}  // namespace

void write_delay_axis(ResultFile& file, const Dynamics& dynamics) {
  const ResultGroup root(file, delays_table);
  file.bind("DELAY", {dynamics.diffusion ? "s" : "1"});
  root.put("delay", dynamics.delays);
  root.attribute("delay", "k2_diffusion", dynamics.motion.diffusion);
  if (dynamics.diffusion) root.attribute("delay", "diffusion", *dynamics.diffusion);
}

void write_delays(ResultFile& file, const Scene& scene, const Dynamics& dynamics,
                  const DelayEstimates& found) {
  const ResultGroup root(file, delays_table);
  const Motion& motion = dynamics.motion;
  write_delay_axis(file, dynamics);
  if (scene.request.has_reference()) {
    root.put("delayed_covariance", found.changes.covariance);
    return root.put("delayed_correlation", found.changes.correlation);
  }
  root.put("intensity_correlation", found.intensity);
  root.attribute("intensity_correlation", "beta", dynamics.exposure.beta);
  root.put("decay_time", found.decay.value);
  root.put("decay_time_censored", std::span(found.decay.censored));
  if (!motion.only_diffuses(scene)) {
    root.put("complex_covariance", found.changes.covariance);
    root.put("complex_correlation", found.changes.correlation);
    return root.put("field_correlation", found.changes.magnitude);
  }
  root.put("covariance", found.changes.covariance);
  root.put("field_correlation", found.changes.correlation);
  if (scene.domain.kind == Domain::Kind::slab && !has_near_endpoints(scene.request))
    write_theory(root, scene, dynamics);
}

}  // namespace flatspeckle::mc
