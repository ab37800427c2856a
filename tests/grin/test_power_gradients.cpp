#include <cmath>
#include <numbers>

#include <doctest/doctest.h>

#include "bench/oracles/peierls_slab.h"
#include "grin/render/transport/path_score.h"
#include "tests/grin/forward_powers.h"

// Derivatives of powers by mu_s, mu_a and g: against closed forms, and against differences of
// powers with the same random numbers.

namespace flatspeckle::grin::tests::test_power_gradients {

namespace {

using std::numbers::pi;

struct Tissue {
  double mu_s, mu_a, g;
};

/// Returns a weak acoustic guide in a box under a beam, with two disks on the far side.
RenderScene guide(const Tissue& tissue, double amplitude = 0.01) {
  RenderScene scene;
  scene.field = StandingWave(0.33, amplitude, 0, 3, 6);
  scene.step = 0.1;
  scene.max_length = 200;
  scene.stage = {.boundary = Box{{-3, -3, 0}, {3, 3, 6}},
                 .medium = {.mu_s = tissue.mu_s, .mu_a = tissue.mu_a}};
  if (tissue.mu_s > 0) scene.stage.medium.phase = SpacePhaseFunction{HgPhase{tissue.g}};
  scene.lights = {BeamLight{{0, 0, 0}, Vec3::UnitZ(), 0.5}};
  scene.leapfrogs = true;
  scene.sensors = {RadialDetector{{0, 0, 6}, 2.5, 2, pi / 2, {1, 2.5}}};
  scene.bins.derivatives = static_cast<int>(parameters_of(scene.stage.medium).size());
  return scene;
}

/// Returns the derivative of the power on the larger disk.
DerivativeEstimate power_derivative(const Powers& powers, std::size_t parameter) {
  const Estimate& within = powers.found.gradients->within;
  return {within.value[2 * parameter + 1].real(), within.error[2 * parameter + 1]};
}

DerivativeEstimate difference(const Powers& high, const Powers& low, double apart) {
  return difference(high, low, apart, [](std::span<const Complex> sums, std::size_t stride) {
    return pi * sums[0].real() + pi * (2.5 * 2.5 - 1) * sums[stride].real();
  });
}

}  // namespace

TEST_CASE("derivatives by absorption in clear media: agree with Beer and Lambert") {
  const Powers all = powers(guide({0, 0.2, 0}, 1e-9), 2000);
  CHECK(all.found.total->value[0].real() == doctest::Approx(std::exp(-1.2)).epsilon(1e-9));
  CHECK(all.found.gradients->within.value.size() == 2);
  for (const std::size_t disk : {0, 1})
    CHECK(all.found.gradients->within.value[disk].real() ==
          doctest::Approx(-6 * std::exp(-1.2)).epsilon(1e-6));
}

/// The reference is -s times the unscattered light; there is hardly any scattered light.
TEST_CASE("derivatives by absorption in weak scattering: agree with Beer and Lambert") {
  const Powers all = powers(guide({1e-6, 0.2, 0.5}, 1e-9), 2000);
  CHECK(power_derivative(all, 1).value == doctest::Approx(-6 * std::exp(-1.2)).epsilon(1e-4));
}

TEST_CASE("derivatives by absorption: agree with the mean path of the light") {
  RenderScene scene = guide({0.4, 0.05, 0.7}, 1e-9);
  scene.bins.moments = true;
  const Powers all = powers(scene, 20000);
  const double path = all.found.paths.value[0].real() / 1.33;
  CHECK(power_derivative(all, 1).value ==
        doctest::Approx(-path * all.found.total->value[0].real()).epsilon(1e-6));
}

TEST_CASE("derivatives by mu_s, mu_a and g: agree with differences of the same paths") {
  const double samples = is_night ? 400000 : 60000;
  const Tissue tissue{0.4, 0.05, 0.7};
  const Powers all = powers(guide(tissue), samples);
  const double by[] = {0.04, 0.02, 0.03};
  for (std::size_t parameter = 0; parameter < 3; ++parameter) {
    if (!is_night && parameter == 1) continue;  // by absorption it is the mean path, tested above
    CAPTURE(parameter);
    const auto moved = [&](double share) {
      Tissue there = tissue;
      double* const all_of_them[] = {&there.mu_s, &there.mu_a, &there.g};
      *all_of_them[parameter] += share * by[parameter];
      return powers(guide(there), samples);
    };
    const DerivativeEstimate one = power_derivative(all, parameter),
                             other = difference(moved(1), moved(-1), 2 * by[parameter]);
    CAPTURE(one.value);
    CAPTURE(one.error);
    CAPTURE(other.value);
    CAPTURE(other.error);
    CHECK(std::abs(one.value - other.value) < 4 * std::hypot(one.error, other.error));
    CHECK(std::hypot(one.error, other.error) < 0.06 * std::abs(one.value));
  }
}

/// The reference is differences of the transmittance by Peierls' equation.
TEST_CASE("derivatives of a slab's transmittance: agree with transport theory") {
  RenderScene scene;
  scene.step = 1;
  scene.max_length = 1e9;
  scene.stage = {.boundary = Box{{-100, -100, 0}, {100, 100, 1}}, .medium = {.mu_s = 1, .mu_a = 1}};
  scene.lights = {BeamLight{{0, 0, 0}, Vec3::UnitZ(), 0.01}};
  scene.sensors = {AreaDetector{{0, 0, 1}, Vec3::UnitY(), 200, 200, {}, pi / 2}};
  scene.bins.derivatives = 2;
  const Powers all = powers(scene, 200000);
  const auto through = [](double mu_s, double mu_a) {
    return oracles::isotropic_slab(mu_s + mu_a, mu_s / (mu_s + mu_a)).transmitted;
  };
  constexpr double apart = 1e-3;
  const double exact[] = {(through(1 + apart, 1) - through(1 - apart, 1)) / (2 * apart),
                          (through(1, 1 + apart) - through(1, 1 - apart)) / (2 * apart)};
  const Estimate& found = all.found.gradients->mean;
  for (std::size_t i = 0; i < 2; ++i) {
    const double value = 200 * 200 * found.value[i].real(), error = 200 * 200 * found.error[i];
    CAPTURE(value);
    CAPTURE(exact[i]);
    CHECK(std::abs(value - exact[i]) < 4 * error);
    CHECK(error < 0.02 * std::abs(exact[i]));
  }
}

TEST_CASE("derivatives of totals and disks: agree with the rings of the picture") {
  const Powers all = powers(guide({0.4, 0.05, 0.7}), 4000);
  const PowerGradients& gradients = *all.found.gradients;
  REQUIRE(gradients.image.value.size() == 6);
  for (std::size_t p = 0; p < 3; ++p) {
    const Complex inner = pi * gradients.image.value[2 * p];
    const Complex outer = pi * (2.5 * 2.5 - 1) * gradients.image.value[2 * p + 1];
    CHECK(std::abs(gradients.within.value[2 * p] - inner) < 1e-12);
    CHECK(std::abs(gradients.within.value[2 * p + 1] - inner - outer) < 1e-12);
    CHECK(std::abs(gradients.mean.value[p] * pi * 2.5 * 2.5 - inner - outer) < 1e-12);
  }
}

TEST_CASE("derivatives: other methods than forward tracing are rejected") {
  CHECK_THROWS_AS(check(guide({0.4, 0.05, 0.7}), {RenderMethod::light}), InputError);
}

}  // namespace flatspeckle::grin::tests::test_power_gradients
