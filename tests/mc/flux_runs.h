#pragma once

#include "bench/oracles/discrete_ordinates.h"
#include "mc/paths/estimators/flux.h"
#include "tests/mc/estimates.h"
#include "tests/statistics.h"

namespace flatspeckle::mc::tests {

struct FluxRun {
  FluxJob job;
  GroupedSums sums;
  FluxEstimates flux;
};

inline FluxRun run_flux(const Scene& scene, const StopRule& stop, std::uint64_t seed,
                        std::size_t bins = 8) {
  FluxRun result{flux_job(scene, bins, flatspeckle::tests::fresh_seed(seed)), {}, {}};
  RunOptions options;
  options.stop = stop;
  options.threads = 2;
  RunState state;
  run_batches(result.job.batches, options, state);
  result.sums = std::move(state.sums);
  result.flux = flux_estimates(result.job, result.sums);
  return result;
}

inline StopRule paths(std::uint64_t samples) {
  StopRule stop;
  stop.samples = samples;
  return stop;
}

inline Scene lit_slab(double optical_depth, double albedo, double g,
                      const std::vector<double>& lights) {
  const auto request = intensity_request(lights, far_views({0}));
  return hg_slab(10, {10 / optical_depth, g, albedo}, request);
}

inline void check_share(const Estimate& found, std::size_t light, double expected) {
  constexpr double accuracy = 1e-5;  // relative, of the theory
  CHECK_WITHIN_4_SIGMA(found.value[light], found.error[light], expected, accuracy * expected);
}

/// Compares the flux of a slab at normal and oblique incidence with discrete ordinates;
/// `precision` is the relative error of each share.
inline void check_slab(double optical_depth, double albedo, double g, double precision,
                       std::uint64_t seed) {
  CAPTURE(optical_depth);
  CAPTURE(albedo);
  CAPTURE(g);
  const std::vector<double> lights = {0, pi / 3};
  const Scene scene = lit_slab(optical_depth, albedo, g, lights);
  StopRule stop;
  stop.target_error = precision;
  const FluxEstimates flux = run_flux(scene, stop, seed).flux;
  const oracles::SlabTransport theory({optical_depth, albedo, oracles::henyey_greenstein(g)},
                                      lights, g == 0.9 ? 80 : 30);
  for (std::size_t light = 0; light < lights.size(); ++light) {
    CAPTURE(lights[light]);
    const double back = theory.reflectance(lights[light]);
    const double through = theory.transmittance(lights[light]);
    const double direct = theory.direct_transmittance(lights[light]);
    check_share(flux.reflectance, light, back);
    check_share(flux.transmittance, light, through);
    if (albedo < 1) check_share(flux.absorptance, light, 1 - back - through - direct);
    CHECK(flux.reflectance.error[light] <= precision * back);
    CHECK(flux.transmittance.error[light] <= 1.01 * precision * through);
    CHECK(direct_transmittance(scene, lights[light]) == doctest::Approx(direct).epsilon(1e-13));
  }
}

}  // namespace flatspeckle::mc::tests
