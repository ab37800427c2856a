// Frequency correlation and derivatives of 3D slabs by transport.

#include <array>
#include <cmath>

#include <doctest/doctest.h>

#include "tests/mc/space/scenes_in_space.h"
#include "tests/mc/space/slabs_in_space.h"
#include "tests/mc/transport/sixth_order.h"
#include "tests/oracles/space_pair_walk.h"

namespace flatspeckle::mc::test_space_dynamics {

namespace {

using Eigen::Vector3d;
using tests::downward;
using tests::hg_in_space;
using tests::hg_space;
using tests::is_night;
using tests::pi;
using tests::SpaceRequest;
using tests::SpaceSlab;
using tests::spherical;

constexpr double wavenumber = 2 * pi;

/// Two channels (light, view); the second view keeps the transverse momentum transfer.
struct Channels {
  Vector3d light1, view1, light2, view2;
};

Channels matched(const Vector3d& light1, const Vector3d& view1, const Vector3d& light2,
                 double shift) {
  Vector3d view2 = light2 - (light1 - view1) / (1 + shift);
  view2.z() = std::copysign(std::sqrt(1 - view2.head<2>().squaredNorm()), view1.z());
  return {light1, view1, light2, view2};
}

/// Requests the covariance of two channels and both intensities; the second view is the one without
/// a shift.
SpaceRequest request_of(const Channels& channels) {
  const Channels same = matched(channels.light1, channels.view1, channels.light2, 0);
  return {{same.light1, same.light2},
          {same.view1, same.view2},
          {{0, 0}, {1, 1}},
          {{0, 1}, {0, 0}, {1, 1}}};
}

Complex covariance(const SpaceSlab& slab, const Channels& channels, bool reversed,
                   double tolerance) {
  return slab_covariance(slab, request_of(channels), reversed, {tolerance}).value[0];
}

Complex at_two_frequencies(const SpaceSlab& slab, const Channels& channels, double shift,
                           bool reversed, double tolerance) {
  const SlabOf<SpaceGeometry, Complex> shifted{
      slab.k, slab.mu_t, slab.depth, slab.layers, {1, shift}};
  return slab_covariance(shifted, request_of(channels), reversed, {tolerance}).value[0];
}

Scene seen(double depth, double optical_depth, double g, double albedo, double light, double view) {
  return tests::in_space(hg_in_space(depth, optical_depth, g, albedo),
                         intensity_request({light}, {far_view(view)}));
}

Complex shifted(const Scene& scene, double shift, bool reversed = false) {
  return slab_covariance(scene, reversed, {1e-7}, {.shift = shift}).value[0];
}

}  // namespace

TEST_CASE("3D frequency correlation: without a shift it equals the covariance") {
  const auto slab = hg_space(200, 3, 0.5, 0.95);
  for (const bool reversed : {false, true}) {
    const Vector3d view = reversed ? Vector3d(-spherical(0.5, 0.003)) : spherical(0.7, 1.1);
    const Channels channels = matched(spherical(0.5, 0), view, spherical(0.501, 0.002), 0);
    const Complex one = covariance(slab, channels, reversed, 1e-4),
                  two = at_two_frequencies(slab, channels, 0, reversed, 1e-4);
    CHECK(std::abs(two - one) < 1e-10 * std::abs(one));
  }
}

TEST_CASE("3D frequency correlation: oblique incidence agrees with walks of field pairs") {
  std::vector<std::array<double, 3>> slabs{{0.6, 4.0, 0.95}};
  if (is_night) slabs.insert(slabs.end(), {{0.0, 2.0, 1.0}, {0.9, 5.0, 0.99}});
  for (const auto& [g, optical_depth, albedo] : slabs) {
    const auto slab = hg_space(200, optical_depth, g, albedo);
    const double k = slab.k / slab.mu_t, shift = (g == 0 ? -0.8 : 0.4) / k;
    for (const bool reversed : {false, true}) {
      const Vector3d view = reversed ? Vector3d(-spherical(0.5, 0.001)) : spherical(0.7, 1.1);
      const Channels channels = matched(spherical(0.5, 0), view, spherical(0.501, 0.002), shift);
      const oracles::SpacePairWalk ladder{k,
                                          optical_depth,
                                          g,
                                          albedo,
                                          channels.light1,
                                          channels.light2,
                                          channels.view1,
                                          channels.view2,
                                          shift};
      auto [value, error] = ladder.estimate(40000, 1, true);
      if (reversed) {
        auto other = ladder;
        other.light2 = -channels.view2;
        other.view2 = -channels.light2;
        const auto more = other.estimate(40000, 2, false);
        value += more.value;
        error = std::hypot(error, more.error);
      }
      const Complex found = at_two_frequencies(slab, channels, shift, reversed, 3e-3);
      CHECK(std::abs(found.real() - value.real()) < 4 * error);
      CHECK(std::abs(found.imag() - value.imag()) < 4 * error);
      CHECK(error < 0.2 * std::abs(found));  // so that the check is significant
      CHECK(std::abs(found - covariance(slab, channels, reversed, 3e-3)) > 6 * error);
    }
  }
}

TEST_CASE("3D frequency correlation: phase derivative agrees with the mean path length") {
  constexpr double depth = 60, mu_t = 0.05, albedo = 0.9;
  for (const double view : {0.0, pi}) {  // backscattering with reversed paths
    const bool reversed = view > 1;
    const Scene scene = seen(depth, mu_t * depth, 0.6, albedo, 0, view);
    const auto by_mu_t = slab_derivatives(scene, reversed, {1e-7}, BulkParameter::mu_t).value,
               by_albedo = slab_derivatives(scene, reversed, {1e-7}, BulkParameter::albedo).value;
    const double intensity = by_mu_t[0].real(),
                 lengths = -(by_mu_t[1] - albedo / mu_t * by_albedo[1]).real(),
                 beyond = lengths - (reversed ? 0 : depth) * intensity;
    const double step = 1e-3 / (wavenumber * depth);
    const Complex derivative =
        (shifted(scene, step, reversed) - shifted(scene, -step, reversed)) / (2 * step);
    CHECK(std::abs(derivative - Complex(0, -wavenumber * beyond)) < 1e-4 * std::abs(derivative));
  }
}

TEST_CASE("3D frequency correlation: a thin slab agrees with single scattering") {
  constexpr double depth = 50, light = 0.4, view = -0.3, optical_depth = 1e-5;
  const Scene scene = seen(depth, optical_depth, 0.5, 1, light, view);
  for (const double shift : {1e-3, 0.02}) {
    const double k2 = wavenumber * (1 + shift),
                 view2 =
                     std::asin(std::sin(light) - (std::sin(light) - std::sin(view)) / (1 + shift)),
                 rate = wavenumber * (std::cos(light) - std::cos(view)) -
                        k2 * (std::cos(light) - std::cos(view2));
    const auto p = [](double angle) {
      return 0.75 / (4 * pi) * std::pow(1.25 - std::cos(angle), -1.5);
    };
    const Complex expected = optical_depth * std::sqrt(p(view - light) * p(view2 - light)) *
                             (std::polar(1.0, rate * depth) - 1.0) / Complex(0, rate * depth);
    CHECK(std::abs(shifted(scene, shift) - expected) < 1e-3 * std::abs(expected));
  }
}

TEST_CASE("3D frequency correlation: a thick slab agrees with diffusion theory") {
  constexpr double depth = 1000;  // mean free paths
  const Scene scene = seen(depth, depth, 0, 1, 0, 0);
  const double intensity = shifted(scene, 0).real();
  for (const double turns : {1.0, 10.0}) {
    const double difference = turns / (depth * depth), shift = -difference / wavenumber;
    // kappa^2 = 3 mu_a / l* (C41), mu_a = -i (k1 - k2); phases are relative to the straight path
    const auto f = [&](Complex q) {
      return std::sinh(0.7104 * q) * std::sinh(1.7104 * q) / (q * std::sinh((depth + 1.4208) * q));
    };
    const Complex expected =
        f(std::sqrt(Complex(0, -3 * difference))) / f(1e-6) * std::polar(1.0, -difference * depth);
    CHECK(std::abs(shifted(scene, shift) / intensity - expected) < 3e-3);
    CHECK(std::abs(expected) < 0.98);
  }
}

namespace {

/// Checks derivatives against differences of the scenes at(step); `scale` is the step over which
/// the values change.
template <typename At>
void check_derivatives(BulkParameter parameter, double scale, bool reversed, const At& at,
                       double tolerance = is_night ? 1e-8 : 1e-6) {
  CAPTURE(static_cast<int>(parameter));
  const Refinement refinement{tolerance, 6};
  tests::check_sixth_order(
      slab_derivatives(at(0), reversed, refinement, parameter).value, scale,
      [&](double step) { return slab_covariance(at(step), reversed, refinement).value; });
}

}  // namespace

TEST_CASE("3D slab transport: derivatives agree with finite differences of converged solutions") {
  struct Case {
    double optical_depth, g, albedo, view;
    bool reversed;
  };
  constexpr double depth = 200;
  for (const Case& slab : {Case{2, 0, 1, 0.1, false}, Case{2, 0.4, 0.9, pi + 0.0003, true}}) {
    CAPTURE(slab.g);
    const auto request = memory_effect_request(wavenumber, 0, {slab.view}, {0.1 / depth});
    const auto scene = [&](double mu_t, double g, double albedo) {
      return tests::in_space(hg_in_space(depth, mu_t * depth, g, albedo), request);
    };
    const double mu_t = slab.optical_depth / depth;
    constexpr double critical = 1.4;  // below the critical albedo of such slabs
    if (slab.albedo < 1)
      check_derivatives(BulkParameter::albedo, critical - slab.albedo, slab.reversed,
                        [&](double step) { return scene(mu_t, slab.g, slab.albedo + step); });
    if (slab.reversed && !is_night) continue;
    check_derivatives(BulkParameter::mu_t, mu_t, slab.reversed,
                      [&](double step) { return scene(mu_t + step, slab.g, slab.albedo); });
    check_derivatives(BulkParameter::g, 1 - std::abs(slab.g), slab.reversed,
                      [&](double step) { return scene(mu_t, slab.g + step, slab.albedo); });
  }
}

TEST_CASE("3D slab transport: derivatives by radius and index of spheres at fixed density") {
  constexpr double depth = 200, radius = 0.2, index = 1.4;
  const auto request = memory_effect_request(wavenumber, 0, {0.1}, {0.1 / depth});
  const auto scene = [&](double wider, double denser) {
    SceneSpec spec = hg_in_space(depth, 2, 0, 1);
    spec.scatterer = "mie";
    spec.dimension = 3;
    spec.g = spec.albedo = std::nullopt;
    spec.optical_depth = std::nullopt;
    spec.density = 0.1;
    spec.radius = radius + wider;
    spec.index = std::to_string(index + denser) + "+0.01i";
    return tests::in_space(spec, request);
  };
  const double finer = is_night ? 1e-8 : 3e-7;
  check_derivatives(
      BulkParameter::radius, radius / 4, false, [&](double step) { return scene(step, 0); }, finer);
  check_derivatives(
      BulkParameter::index, 0.1, false, [&](double step) { return scene(0, step); }, finer);
}

}  // namespace flatspeckle::mc::test_space_dynamics
