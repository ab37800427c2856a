#include <cmath>

#include <doctest/doctest.h>

#include "mc/paths/estimators/flux.h"
#include "mc/slab/slab_flux.h"
#include "tests/mc/space/scenes_in_space.h"
#include "tests/oracles/photon_walk.h"

namespace flatspeckle::mc::test_space_flux {

namespace {

using std::numbers::pi;

FluxEstimates estimates(const Scene& scene, std::size_t bins, double tolerance) {
  const FluxJob job = slab_flux_job(scene, bins, {tolerance});
  return flux_estimates(job, tests::summed(job.batches, 2));
}

Scene lit(const SceneSpec& spec, double light) {
  return tests::in_space(spec, intensity_request({light}, {far_view(0)}));
}

double lost(const Scene& scene, const FluxEstimates& flux) {
  return 1 - direct_transmittance(scene, scene.request.lights[0].angle) -
         (flux.reflectance.value[0] + flux.transmittance.value[0]).real();
}

}  // namespace

TEST_CASE("3D slab flux: reflectance and transmittance agree with van de Hulst (1980)") {
  const Scene scene = lit(tests::hg_in_space(1, 2, 0.75, 0.9), 0);
  const auto found = estimates(scene, 4, 1e-7);
  CHECK(std::abs(found.reflectance.value[0] - 0.09739) < 0.5e-5);  // van de Hulst 1980
  CHECK(std::abs(found.transmittance.value[0] + std::exp(-2.0) - 0.66096) < 0.5e-5);
  CHECK(found.absorptance.value[0].real() == doctest::Approx(lost(scene, found)));
}

TEST_CASE("3D slab flux: lossless slabs conserve power, angle bins sum to the totals") {
  for (const double g : {-0.5, 0.9, 0.98})
    for (const double light : {0.0, -1.3}) {
      const Scene scene = lit(tests::hg_in_space(1, 5, g, 1), light);
      constexpr std::size_t bins = 12;
      const auto found = estimates(scene, bins, 1e-6);
      CHECK(std::abs(lost(scene, found)) < 1e-9);
      double reflected = 0, transmitted = 0;
      for (std::size_t bin = 0; bin < bins; ++bin)
        (bin < bins / 2 ? transmitted : reflected) +=
            found.exit_radiance.value[bin].real() * pi / bins;
      CHECK(transmitted == doctest::Approx(found.transmittance.value[0].real()).epsilon(1e-5));
      CHECK(reflected == doctest::Approx(found.reflectance.value[0].real()).epsilon(1e-5));
    }
}

TEST_CASE("3D flux: walks through slabs agree with transport") {
  for (const auto& [g, albedo] : {std::pair{0.0, 0.9}, {0.8, 1.0}}) {
    const Scene scene = lit(tests::hg_in_space(1, 3, g, albedo), 0.4);
    const FluxJob job = flux_job(scene, 4, 1);
    const FluxEstimates found = flux_estimates(job, tests::summed(job.batches, 40000)),
                        expected = estimates(scene, 4, 1e-5);
    CHECK_WITHIN_4_SIGMA(found.reflectance.value[0], found.reflectance.error[0],
                         expected.reflectance.value[0], 0);
    CHECK_WITHIN_4_SIGMA(found.transmittance.value[0], found.transmittance.error[0],
                         expected.transmittance.value[0], 0);
    for (std::size_t bin = 0; bin < 4; ++bin)
      CHECK_WITHIN_4_SIGMA(found.exit_radiance.value[bin], found.exit_radiance.error[bin],
                           expected.exit_radiance.value[bin], 0);
  }
}

TEST_CASE("3D flux: shares of boxes sum to 1, and turned boxes exchange face and sides") {
  SceneSpec spec = tests::hg_in_space(2, 2, 0.5, 0.9);
  spec.dimension = 3;
  spec.domain = "box";
  spec.width = 3;
  spec.height = 4;
  const Light light = plane_wave(0.7, 0.3);
  const auto shares = [](const SceneSpec& own, const Light& from) {
    Scene scene = mc::in_space(make_scene(own), own);
    scene.request = intensity_request(Lights{from}, {far_view(0)});
    const FluxJob job = flux_job(scene, 2, 3);
    const GroupedSums sums = tests::summed(job.batches, 40000);
    const Invariant power = power_balance(job, sums, unscattered_shares(scene)).front();
    CHECK(power.holds());
    return flux_estimates(job, sums);
  };
  const FluxEstimates upright = shares(spec, light);
  // It is the same box with y as its depth.
  const Vec w = light.direction();
  SceneSpec turned = spec;
  turned.depth = spec.height;
  turned.optical_depth = 2 * *spec.height / *spec.depth;
  turned.height = spec.depth;
  const Light other = plane_wave(std::acos(w.y), std::atan2(w.z, w.x));
  const FluxEstimates lying = shares(turned, other);
  CHECK_WITHIN_4_SIGMA(upright.absorptance.value[0],
                       std::hypot(upright.absorptance.error[0], lying.absorptance.error[0]),
                       lying.absorptance.value[0], 0);
}

TEST_CASE("3D slab flux: lossless spheres conserve power") {
  SceneSpec spec = tests::hg_in_space(1, 5, 0, 1);
  spec.g = spec.albedo = std::nullopt;
  spec.scatterer = "mie";
  spec.dimension = 3;
  spec.radius = 1.5;
  spec.index = "1.33";
  const Scene scene = lit(spec, 0.3);
  CHECK(std::abs(lost(scene, estimates(scene, 1, 1e-5))) < 1e-9);
}

TEST_CASE("3D slab flux: exit radiance by polar angle agrees with counted photons") {
  constexpr double incidence = 0.6, wide = 1e5, optical_depth = 3, albedo = 0.9, g = 0.8;
  constexpr std::size_t bins = 8;
  constexpr std::uint64_t photons = 400000;
  oracles::WalkScene walk{{{-wide, -wide, 0}, {wide, wide, 1}}};
  walk.medium = {.mu_s = albedo * optical_depth,
                 .mu_a = (1 - albedo) * optical_depth,
                 .law = oracles::WalkMedium::Law::henyey_greenstein,
                 .g = g};
  const oracles::Photon start{{0, 0, 1e-12}, {std::sin(incidence), 0, std::cos(incidence)}};
  std::vector<double> counts(bins);
  oracles::walk_photons(
      walk, [&](oracles::Random&) { return start; }, photons, 1,
      [&](const oracles::Photon& photon) {
        if (photon.scatterings == 0) return;
        const double turn = std::acos(photon.direction.z()) / pi;
        ++counts[static_cast<std::size_t>(turn * bins)];
      });
  const auto found =
      estimates(lit(tests::hg_in_space(1, optical_depth, g, albedo), incidence), bins, 1e-6);
  for (std::size_t bin = 0; bin < bins; ++bin) {
    const double share = counts[bin] / photons, error = std::sqrt(share * (1 - share) / photons);
    CHECK_WITHIN_4_SIGMA(found.exit_radiance.value[bin] * (pi / bins), error, share, 0);
  }
}

}  // namespace flatspeckle::mc::test_space_flux
