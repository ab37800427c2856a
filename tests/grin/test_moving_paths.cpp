#include <cmath>
#include <numbers>

#include <doctest/doctest.h>

#include "bench/oracles/guided_beam.h"
#include "bench/oracles/quadrature.h"
#include "grin/render/sensors/sensor_edges.h"
#include "tests/grin/forward_powers.h"
#include "tests/statistics.h"

// Derivatives of powers by parameters of the index field, against closed forms and against
// differences of powers with the same random numbers.

namespace flatspeckle::grin::tests::test_moving_paths {

namespace {

using std::numbers::pi;

using oracles::guided_values;
using oracles::GuidedBeam;

const std::vector<double> radii{0.3, 0.6};

RenderValues with(RenderValues values, std::vector<std::string> by) {
  values.gradient_by = std::move(by);
  return values;
}

Powers powers(const RenderValues& values, double samples) {
  return tests::powers(make_render_scene(values), samples);
}

const double usual_samples = is_night ? 120000 : 40000;

/// Compares derivatives at these pixels with differences by this member of the values.
template <class Member>
void check_differences(const RenderValues& values, const std::string& name, const Member& member,
                       const std::vector<std::size_t>& pixels, double pixel_area,
                       double samples = usual_samples, double apart = 0.06) {
  CAPTURE(name);
  const Powers all = powers(with(values, {name}), samples);
  RenderValues less = values, more = values;
  member(less) *= 1 - apart;
  member(more) *= 1 + apart;
  const Powers low = powers(less, samples), high = powers(more, samples);
  for (const std::size_t pixel : pixels) {
    CAPTURE(pixel);
    const DerivativeEstimate other =
        difference(high, low, member(more) - member(less),
                   [&](std::span<const Complex> sums, std::size_t stride) {
                     return pixel_area * sums[pixel * stride].real();
                   });
    const Estimate& image = all.found.gradients->image;
    const DerivativeEstimate one{pixel_area * image.value[pixel].real(),
                                 pixel_area * image.error[pixel]};
    CAPTURE(one.value);
    CAPTURE(one.error);
    CAPTURE(other.value);
    CAPTURE(other.error);
    CHECK(std::abs(one.value - other.value) < 4 * std::hypot(one.error, other.error));
    CHECK(std::hypot(one.error, other.error) < 0.1 * std::abs(one.value));
  }
}

}  // namespace

TEST_CASE("derivatives of clear light by the field: agree with the closed form") {
  for (const double length : {6.0, 15.0}) {
    CAPTURE(length);
    const GuidedBeam guide{0.2, length};
    const Powers all = powers(with(guided_values(guide, radii), {"alpha"}), 64);
    const Estimate& within = all.found.gradients->within;
    CHECK(within.value[0].real() == doctest::Approx(guide.by_alpha(0.3)).epsilon(2e-6));
    CHECK(within.error[0] < 1e-6);
    if (length < 10)
      CHECK(within.value[1].real() == doctest::Approx(guide.by_alpha(0.6)).epsilon(2e-6));
  }
}

TEST_CASE("derivatives of absorbed light by the field: agree with the closed form") {
  const GuidedBeam guide{0.2, 6, 0.5};
  const Powers all = powers(with(guided_values(guide, radii), {"alpha"}), 20000);
  const Estimate& within = all.found.gradients->within;
  for (std::size_t i = 0; i < 2; ++i) {
    const double exact = guide.by_alpha(i == 0 ? 0.3 : 0.6);
    CAPTURE(exact);
    CAPTURE(within.error[i]);
    CHECK(std::abs(within.value[i].real() - exact) < 4 * within.error[i] + 1e-6);
    CHECK(within.error[i] < 1e-4);
  }
}

TEST_CASE("derivatives by the field: agree with differences of the same paths") {
  const auto alpha = [](RenderValues& values) -> double& {
    return *values.field.of<ParabolicValues>().alpha;
  };
  // the density of paths contributes a third; by day, only the test of absorbed light covers that
  if (is_night) {
    SUBCASE("of isotropic light, on a wide disk") {
      check_differences(guided_values({0.25, 6}, {2.5}, 1), "alpha", alpha, {0}, pi * 2.5 * 2.5);
    }
  }
  // here it contributes a tenth
  RenderValues forward = guided_values({0.25, 6}, radii, 0.5, 0.8);
  SUBCASE("of forward light, on a small disk") {
    check_differences(forward, "alpha", alpha, {0}, pi * 0.3 * 0.3);
  }
  forward = guided_values({0.25, 6, 0.02}, radii, 0.25, 0.8);
  SUBCASE("of forward light, on pixels beside the axis") {
    forward.sensors = {};
    forward.sensors.sensor = {AreaValues::word};
    forward.sensors.of<AreaValues>().sensor_at = {0.3, 0.1, 6};
    forward.sensors.of<AreaValues>().sensor_size = {1, 0.8};
    forward.sensors.pixels = {2, 1};
    check_differences(forward, "alpha", alpha, {0, 1}, 0.4, usual_samples, 0.03);
  }
  SUBCASE("by sound") {
    forward.field = {};
    forward.field.field = {UltrasoundValues::word};
    auto& sound = forward.field.of<UltrasoundValues>();
    sound.index = 1.33;
    sound.amplitude = 0.02;
    sound.sound_wavenumber = 2;
    const auto amplitude = [](RenderValues& values) -> double& {
      return *values.field.of<UltrasoundValues>().amplitude;
    };
    const auto wavenumber = [](RenderValues& values) -> double& {
      return *values.field.of<UltrasoundValues>().sound_wavenumber;
    };
    if (is_night) check_differences(forward, "amplitude", amplitude, {0}, pi * 0.3 * 0.3);
    check_differences(forward, "sound_wavenumber", wavenumber, {0}, pi * 0.3 * 0.3,
                      usual_samples / 3);
  }
}

/// Rays are almost straight. The power on the disk from a light given by L/n^2 or by a numerical
/// aperture depends on the square of the index.
TEST_CASE("derivatives of emission by the index: agree with the closed form") {
  RenderValues straight = guided_values({1e-4, 4}, {1});
  straight.lights = {};
  SUBCASE("a face") {
    straight.lights.face_light = {0, 0, 0, 0.5, 1};
    const Powers all = powers(with(straight, {"index"}), 20000);
    const double exact = 2 / 1.5 * all.found.within->power.value[0].real();
    CHECK(all.found.gradients->within.value[0].real() == doctest::Approx(exact).epsilon(1e-6));
  }
  SUBCASE("a fibre") {
    straight.lights.fibre_light = {0, 0, 0, 0, 0, 1, 1e-6, 0.6, 1};
    const Powers all = powers(with(straight, {"index"}), 50000);
    const Estimate& within = all.found.gradients->within;
    const double sine2 = 1 / (1.0 + 4 * 4), exact = 2 * 1.5 * sine2 / (0.6 * 0.6);
    CHECK(std::abs(within.value[0].real() - exact) < 4 * within.error[0]);
    CHECK(within.error[0] < 0.02 * exact);
  }
}

TEST_CASE("derivatives by the index: agree with differences of the same paths, for every light") {
  const auto index = [](RenderValues& values) -> double& {
    return values.field.of<ParabolicValues>().index;
  };
  RenderValues fog = guided_values({0.1, 6}, {2}, 0.05, 0.8);
  fog.lights = {};
  SUBCASE("a face") {
    fog.lights.face_light = {0, 0, 0, 1, 1};
  }
  SUBCASE("a fibre") {
    fog.lights.fibre_light = {0, 0, 0, 0, 0, 1, 0.5, 0.6, 1};
  }
  if (is_night) {
    SUBCASE("the environment") {
      fog.lights.environment = 1;
    }
    SUBCASE("a Gaussian fibre") {
      fog.lights.gaussian_fibre = {0, 0, 0, 0, 0, 1, 0.5, 0.3, 1};
    }
  }
  check_differences(fog, "index", index, {0}, pi * 2 * 2, is_night ? 120000 : 60000);
}

/// Turns with 1 - g = 1e-9 are negligible: the picture is that of unscattered light.
TEST_CASE("derivatives in fog without turns: agree with the closed form of clear light") {
  const GuidedBeam guide{0.2, 6};
  const RenderValues fog = guided_values(guide, radii, 0.5, 1 - 1e-9);
  const Powers all = powers(with(fog, {"alpha"}), is_night ? 100000 : 20000);
  const Estimate& within = all.found.gradients->within;
  for (std::size_t i = 0; i < 2; ++i) {
    const double exact = guide.by_alpha(i == 0 ? 0.3 : 0.6);
    CAPTURE(exact);
    CAPTURE(within.value[i].real());
    CAPTURE(within.error[i]);
    CHECK(std::abs(within.value[i].real() - exact) < 4 * within.error[i]);
    CHECK(within.error[i] < 0.06 * exact);
  }
}

/// The disk contains the whole beam, so that only the density of paths changes.
TEST_CASE("derivatives of absorbed light in fog without turns: agree with the closed form") {
  const GuidedBeam guide{0.2, 6, 0.5};
  const Powers all = powers(with(guided_values(guide, {2}, 0.5, 1 - 1e-6), {"alpha"}), 40000);
  const Estimate& within = all.found.gradients->within;
  const double exact = guide.by_alpha(2);
  CAPTURE(exact);
  CAPTURE(within.value[0].real());
  CAPTURE(within.error[0]);
  CHECK(std::abs(within.value[0].real() - exact) < 4 * within.error[0]);
  CHECK(within.error[0] < 0.025 * std::abs(exact));
}

TEST_CASE("derivatives: those by the medium precede those by the field") {
  RenderValues both = with(guided_values({0.2, 6}, radii, 0.5, 0.5), {"alpha", "index"});
  both.gradient = true;
  const Powers all = powers(both, 1000);
  const Estimate& within = all.found.gradients->within;
  CHECK(gradient_names(make_render_scene(both)) ==
        std::vector<std::string>{"mu_s", "mu_a", "g", "alpha", "index"});
  CHECK(within.value.size() == 10);
  CHECK(within.error.size() == 10);
  CHECK(within.rare.size() == 10);
}

TEST_CASE("edge kernel: normalised, without a second moment") {
  oracles::GaussPanels points;
  points.add(-1, 1);
  const auto moment = [&](int power) {
    double sum = 0;
    for (std::size_t i = 0; i < points.node.size(); ++i)
      sum += points.weight[i] * std::pow(points.node[i], power) * edge_kernel(points.node[i]);
    return sum;
  };
  CHECK(moment(0) == doctest::Approx(1));
  CHECK(std::abs(moment(2)) < 1e-12);
  CHECK(moment(4) == doctest::Approx(-1.0 / 21));
}

}  // namespace flatspeckle::grin::tests::test_moving_paths
