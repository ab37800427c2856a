#include <cmath>

#include <doctest/doctest.h>

#include "bench/oracles/discrete_ordinates.h"
#include "mc/slab/slab_flux.h"
#include "tests/mc/flux_runs.h"

namespace flatspeckle::mc::test_slab_flux {

namespace {

using tests::lit_slab;
using tests::pi;

FluxEstimates estimates(const Scene& scene, std::size_t bins, const Refinement& refinement = {}) {
  const FluxJob job = slab_flux_job(scene, bins, refinement);
  return flux_estimates(job, tests::summed(job.batches, 2));
}

}  // namespace

TEST_CASE("flux by transport: shares agree with adding and doubling") {
  const std::vector<double> lights = {0, pi / 3, -1.5};
  for (const double g : {0.0, 0.8, -0.5}) {
    for (const double optical_depth : {1e-3, 1.0, 20.0}) {
      for (const double albedo : {1.0, 0.9}) {
        const auto flux = estimates(lit_slab(optical_depth, albedo, g, lights), 8);
        const oracles::SlabTransport theory({optical_depth, albedo, oracles::henyey_greenstein(g)},
                                            lights, 60);
        for (std::size_t i = 0; i < lights.size(); ++i) {
          CAPTURE(g);
          CAPTURE(optical_depth);
          CAPTURE(lights[i]);
          CHECK(flux.reflectance.value[i].real() ==
                doctest::Approx(theory.reflectance(lights[i])).epsilon(1e-6));
          CHECK(flux.transmittance.value[i].real() ==
                doctest::Approx(theory.transmittance(lights[i])).epsilon(1e-6));
        }
      }
    }
  }
}

TEST_CASE("flux by transport: thick lossless slabs conserve power") {
  for (const double g : {0.0, 0.9}) {
    const auto flux = estimates(lit_slab(1e4, 1, g, {0.3}), 1);
    CHECK(flux.reflectance.value[0].real() + flux.transmittance.value[0].real() ==
          doctest::Approx(1).epsilon(1e-9));
    // Diffusion in the plane: T (depth + 2 z0) is a constant, z0 = 0.818 transport mean free paths.
    const auto twice = estimates(lit_slab(2e4, 1, g, {0.3}), 1);
    CHECK((1e4 * (1 - g) + 1.636) / (2e4 * (1 - g) + 1.636) ==
          doctest::Approx((twice.transmittance.value[0] / flux.transmittance.value[0]).real())
              .epsilon(1e-5));
  }
}

TEST_CASE("flux by transport: exit radiance agrees with Monte Carlo") {
  constexpr std::size_t bins = 12;
  const Scene scene = lit_slab(5, 0.95, 0.8, {0.7});
  const auto found = tests::run_flux(scene, tests::paths(200000), 3, bins).flux;
  const auto expected = estimates(scene, bins);
  double total = 0;
  for (std::size_t bin = 0; bin < bins; ++bin) {
    CHECK_WITHIN_4_SIGMA(found.exit_radiance.value[bin], found.exit_radiance.error[bin],
                         expected.exit_radiance.value[bin], 0);
    total += expected.exit_radiance.value[bin].real() * 2 * pi / bins;
  }
  CHECK(total ==
        doctest::Approx((expected.reflectance.value[0] + expected.transmittance.value[0]).real()));
  CHECK_WITHIN_4_SIGMA(found.absorptance.value[0], found.absorptance.error[0],
                       expected.absorptance.value[0], 0);
}

TEST_CASE("flux by transport: without scattering only absorption") {
  const auto flux = estimates(lit_slab(0.7, 0, 0, {0.0}), 4);
  CHECK(flux.absorptance.value[0].real() == doctest::Approx(1 - std::exp(-0.7)));
  CHECK(flux.reflectance.value[0] == 0.0);
}

}  // namespace flatspeckle::mc::test_slab_flux
