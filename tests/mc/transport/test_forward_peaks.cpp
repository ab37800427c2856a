#include <cmath>
#include <cstdint>
#include <numbers>

#include <doctest/doctest.h>

#include "mc/slab/adding/phase_moments.h"
#include "mc/slab/slab_flux.h"
#include "tests/mc/space/scenes_in_space.h"
#include "tests/oracles/photon_walk.h"

namespace flatspeckle::mc::test_forward_peaks {

namespace {

using std::numbers::pi;

/// Reflectance, transmittance, absorptance and unscattered share of one light.
struct Shares {
  double reflectance, transmittance, absorptance, direct;
  double error;  ///< largest stated error, relative

  double sum() const { return reflectance + transmittance + absorptance + direct; }
};

Scene slab(int dimension, double optical_depth, double g, double albedo, double light) {
  const auto request = intensity_request({light}, {far_view(0)});
  SceneSpec spec = tests::hg_in_space(1, optical_depth, g, albedo);
  Scene scene = make_scene(spec);
  if (dimension == 3) return tests::in_space(spec, request);
  scene.request = request;
  return scene;
}

Shares shares(const Scene& scene, double tolerance) {
  const Refined found = slab_flux(scene, 4, {tolerance});
  const auto value = [&](FluxShare share) { return found.value[share].real(); };
  double error = 0;
  for (const FluxShare share : {reflected, transmitted, absorbed})
    if (value(share) != 0) error = std::max(error, std::abs(found.error[share] / value(share)));
  return {value(reflected), value(transmitted), value(absorbed),
          direct_transmittance(scene, scene.request.lights[0].angle), error};
}

/// Returns the share of single scattering into the backward hemisphere.
double backward_share(int dimension, double g) {
  if (dimension == 2) return 2 / pi * std::atan((1 - g) / (1 + g));
  return (1 - g) / (2 * g) * ((1 + g) / std::sqrt(1 + g * g) - 1);
}

}  // namespace

TEST_CASE("phase moments: kept as far as they exceed rounding errors") {
  for (const int dimension : {2, 3})
    for (const double g : {0.5, -0.9, 0.9, 0.98}) {
      CAPTURE(dimension);
      CAPTURE(g);
      const auto p = [=](double angle) {
        const double distance = (1 - g) * (1 - g) + 4 * g * std::pow(std::sin(angle / 2), 2);
        return 1 / (dimension == 3 ? std::pow(distance, 1.5) : distance);
      };
      const PhaseMoments moments([&](int count) { return first_moments(dimension, p, {}, count); },
                                 2048);
      CHECK(moments.kept().list.size() ==
            doctest::Approx(std::log(1e-13) / std::log(std::abs(g))).epsilon(0.03));
      CHECK(moments.kept().list[40] == doctest::Approx(std::pow(g, 40)).epsilon(1e-6));
    }
}

TEST_CASE("slab transport: the power balance closes and detects an error of 1 %") {
  const Scene scene = slab(2, 2, 0.9, 0.9, 0.5);
  const FluxJob job = slab_flux_job(scene, 1, {1e-6});
  for (const double factor : {1.0, 1.01}) {
    GroupedSums sums(job.batches.size);
    for (const std::uint64_t number : {0, 1}) {
      std::vector<Complex> batch(job.batches.size);
      job.batches.run(number, batch);
      batch[reflected] *= factor;
      sums.add(1, batch);
    }
    CHECK(power_balance(job, sums, unscattered_shares(scene)).front().holds() == (factor == 1));
  }
}

TEST_CASE("slab transport: extreme forward peaks act as absorption alone") {
  for (const int dimension : {2, 3})
    for (const double g : {1 - 1e-7, 1 - 1e-9})
      for (const double optical_depth : {1e-6, 10.0})
        for (const double albedo : {1.0, 0.9}) {
          const double light = albedo == 1 ? 1.2 : 0.3;
          const Shares found = shares(slab(dimension, optical_depth, g, albedo, light), 1e-5);
          const double crossed = std::exp(-(1 - albedo) * optical_depth / std::cos(light));
          CHECK(std::abs(found.sum() - 1) < 1e-12);
          CHECK(std::abs(found.transmittance + found.direct - crossed) <
                1e2 * (1 - g) * optical_depth);
        }
}

TEST_CASE("slab transport: reflectance of a thin slab agrees with single scattering") {
  for (const int dimension : {2, 3})
    for (const double g : {0.9, 0.999, 1 - 1e-9}) {
      const double optical_depth = 1e-6;
      const Shares found = shares(slab(dimension, optical_depth, g, 1, 0), 1e-5);
      CHECK(found.error < 1e-5);
      CHECK(found.reflectance ==
            doctest::Approx(optical_depth * backward_share(dimension, g)).epsilon(3e-5));
    }
}

TEST_CASE("slab transport: oblique light on a 3D forward peak agrees with counted photons") {
  constexpr double incidence = 1.2, wide = 1e5, g = 0.999;
  constexpr std::uint64_t photons = 400000;
  oracles::WalkScene walk{{{-wide, -wide, 0}, {wide, wide, 1}}};
  walk.medium = {.mu_s = 1, .law = oracles::WalkMedium::Law::henyey_greenstein, .g = g};
  const oracles::Photon start{{0, 0, 1e-12}, {std::sin(incidence), 0, std::cos(incidence)}};
  double back = 0;
  oracles::walk_photons(
      walk, [&](oracles::Random&) { return start; }, photons, 1,
      [&](const oracles::Photon& photon) { back += photon.direction.z() < 0 ? 1.0 : 0.0; });
  const double share = back / photons, error = std::sqrt(share / photons);
  const Shares found = shares(slab(3, 1, g, 1, incidence), 1e-6);
  CHECK(std::abs(found.sum() - 1) < 1e-12);
  CHECK(std::abs(found.reflectance - share) < 4 * error);
}

/// Checks that stated errors cover the change to a tolerance a hundred times smaller, and power.
void check_errors(int dimension, double optical_depth, double g, double albedo, double light) {
  CAPTURE(dimension);
  CAPTURE(optical_depth);
  CAPTURE(g);
  CAPTURE(albedo);
  const Scene scene = slab(dimension, optical_depth, g, albedo, light);
  const Refined rough = slab_flux(scene, 4, {1e-3}), fine = slab_flux(scene, 4, {1e-5});
  double sum = direct_transmittance(scene, light);
  for (const FluxShare share : {reflected, transmitted, absorbed}) {
    sum += fine.value[share].real();
    CHECK(std::abs(rough.value[share] - fine.value[share]) <=
          std::abs(rough.error[share]) + std::abs(fine.error[share]) + 1e-15);
  }
  CHECK(std::abs(sum - 1) < 1e-9);
}

TEST_CASE("slab transport: power is conserved and errors hold over g, depth and albedo") {
  for (const int dimension : {2, 3})
    for (const double g : {-0.9, 0.99, 0.9999})
      for (const double optical_depth : {0.1, 1e4})
        check_errors(dimension, optical_depth, g, 0.99, 1);
}

TEST_CASE("nightly: slab transport: power is conserved and errors hold on the whole grid") {
  for (const int dimension : {2, 3})
    for (const double g :
         {0.0, 0.5, 0.9, 0.99, 0.999, 1 - 1e-5, 1 - 1e-7, 1 - 1e-9, -0.5, -0.9, -0.99})
      for (const double optical_depth : {1e-6, 1e-3, 1.0, 100.0, 1e4})
        for (const double albedo : {1.0, 0.999, 0.5, 0.01})
          for (const double light : {0.0, 1.2})
            check_errors(dimension, optical_depth, g, albedo, light);
}

}  // namespace flatspeckle::mc::test_forward_peaks
