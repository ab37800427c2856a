#include <array>

#include <doctest/doctest.h>

#include "tests/mc/space/scenes_in_space.h"
#include "tests/mc/space/slabs_in_space.h"
#include "tests/oracles/space_pair_walk.h"

namespace flatspeckle::mc::test_space_covariance {

namespace {

using Eigen::Vector3d;
using std::numbers::pi;
using tests::against_first;
using tests::downward;
using tests::hg_space;
using tests::SpaceRequest;
using tests::SpaceSlab;
using tests::spherical;

constexpr double usual_depth = 2000;

/// Returns, for light and view along the normal, the intensity and then C_I at tilts of q L.
std::vector<double> memory_effect(const SpaceSlab& slab, const std::vector<double>& turns,
                                  double tolerance) {
  std::vector<Vector3d> lights{downward(0, 0)};
  for (const double turn : turns) lights.push_back(downward(turn / (slab.k * slab.depth), 0));
  const auto found = slab_covariance(slab, against_first(lights, lights), false, {tolerance});
  const std::size_t n = turns.size();
  std::vector<double> values{found.value[n].real()};
  for (std::size_t i = 0; i < n; ++i)
    values.push_back(std::norm(found.value[i]) / found.value[n].real() /
                     found.value[n + 1 + i].real());
  return values;
}

/// Returns the covariance of two channels (light, view).
Complex covariance(const SpaceSlab& slab, const SpacePair& lights, const SpacePair& views,
                   bool reversed, double tolerance) {
  const SpaceRequest request{{lights.first, lights.second},
                             {views.first, views.second},
                             {{0, 0}, {1, 1}},
                             {{0, 1}, {0, 0}, {1, 1}}};
  return slab_covariance(slab, request, reversed, {tolerance}).value[0];
}

/// Oblique light and a view at its own angle and azimuth, both tilted along x by q1 and along y by
/// q2 over the depth.
struct Tilted {
  SpacePair lights, views;
};

Tilted tilted(const SpaceSlab& slab, const Vector3d& view, double q1, double q2) {
  const Vector3d light = spherical(0.5, 0);
  const auto moved = [&](const Vector3d& from) {
    const double turn = 1 / (slab.k * slab.depth);
    Vector3d to = downward(from.x() + q1 * turn, from.y() + q2 * turn);
    if (from.z() < 0) to.z() = -to.z();
    return to;
  };
  return {{light, moved(light)}, {view, moved(view)}};
}

}  // namespace

TEST_CASE("3D slab transport: intensities, correlations and ranges agree with known values") {
  const auto check = [](double g, const std::array<double, 4>& known, double range) {
    const auto found = memory_effect(hg_space(usual_depth, 10, g, 1), {1.2, 1.4, 1.6, range}, 1e-5);
    CHECK(std::abs(found[0] / known[0] - 1) < 5e-5);
    for (std::size_t i = 1; i < 4; ++i) CHECK(std::abs(found[i] - known[i]) < 0.6e-4);
    CHECK(std::abs(found[4] - 0.5) < 1e-4);  // 2e-4 of the range
  };
  check(0, {0.058862, 0.5923, 0.4977, 0.4106}, 1.3950);
  check(0.5, {0.10584, 0.5627, 0.4675, 0.3820}, 1.3295);
}

TEST_CASE("3D slab transport: the covariance is reciprocal at any azimuth") {
  const auto slab = hg_space(200, 3, 0.5, 0.95);  // the ordinates have no foci: both use one grid
  for (const double angle : {0.7, 2.4}) {
    const auto [lights, views] = tilted(slab, spherical(angle, 1.1), 1.5, -2.5);
    const Complex there = covariance(slab, lights, views, false, 1e-2),
                  back = covariance(slab, turned_round(views), turned_round(lights), false, 1e-2);
    CHECK(std::abs(there - back) < 1e-10 * std::abs(there));
  }
}

TEST_CASE("3D slab transport: errors are below the tolerance") {
  const auto slab = hg_space(200, 4, 0.6, 0.97);
  const auto [lights, views] = tilted(slab, -spherical(0.5, 0.001), 1, 2);
  const Complex exact = covariance(slab, lights, views, true, 1e-5);
  for (const double tolerance : {1e-2, 1e-3})
    CHECK(std::abs(covariance(slab, lights, views, true, tolerance) - exact) <
          tolerance * std::abs(exact));
}

TEST_CASE("3D slab transport: converges to nine digits") {
  const auto slab = hg_space(usual_depth, 10, 0.5, 1);
  const auto rough = memory_effect(slab, {1.4}, 1e-6), exact = memory_effect(slab, {1.4}, 1e-9);
  for (std::size_t i = 0; i < 2; ++i) CHECK(std::abs(rough[i] / exact[i] - 1) < 1e-9);
}

TEST_CASE("3D slab transport: covariance at oblique incidence agrees with walks of field pairs") {
  const std::uint64_t photons = tests::is_night ? 40000 : 10000;
  for (const auto& [g, optical_depth, albedo] :
       {std::array{0.0, 2.0, 1.0}, {0.6, 4.0, 0.95}, {0.9, 5.0, 0.99}}) {
    const auto slab = hg_space(200, optical_depth, g, albedo);
    for (const double angle : {0.7, 2.7})
      for (const bool reversed : {false, true}) {
        if (reversed && angle > 1) continue;  // backscattering is tested at one angle
        const Vector3d view = reversed ? Vector3d(-spherical(0.5, 0.001)) : spherical(angle, 1.1);
        const auto [lights, views] = tilted(slab, view, 1.5, -2.5);
        const oracles::SpacePairWalk ladder{
            slab.k / slab.mu_t, optical_depth, g,           albedo,
            lights.first,       lights.second, views.first, views.second};
        auto [value, error] = ladder.estimate(photons, 1, true);
        if (reversed) {
          auto other = ladder;
          other.light2 = -views.second;
          other.view2 = -lights.second;
          const auto more = other.estimate(photons, 2, false);
          value += more.value;
          error = std::hypot(error, more.error);
        }
        const Complex found =
            covariance(slab, lights, views, reversed, tests::is_night ? 1e-3 : 3e-3);
        CHECK(std::abs(found.real() - value.real()) < 4 * error);
        CHECK(std::abs(found.imag() - value.imag()) < 4 * error);
        CHECK(error < (tests::is_night ? 0.15 : 0.22) * std::abs(found));  // a significant check
      }
  }
}

TEST_CASE(
    "nightly: 3D slab transport: forward peaks and absorption agree with walks of field pairs") {
  constexpr double depth = 1000;
  for (const double g : {0.9, 0.98})
    for (const double albedo : {0.9, 1.0}) {
      const auto slab = tests::hg_space(depth, 5, g, albedo);
      for (const double turn : {0.0, 2.0, 5.0}) {
        const auto normal = tests::downward(0, 0),
                   tilted = tests::downward(turn / slab.k / depth, 0);
        const oracles::SpacePairWalk walk{
            slab.k / slab.mu_t, 5, g, albedo, normal, tilted, normal, tilted};
        const auto [value, error] = walk.estimate(400000, flatspeckle::tests::fresh_seed(1), true);
        const auto request = tests::against_first({normal, tilted}, {normal, tilted});
        const auto found = slab_covariance(slab, request, false, {1e-4}).value[0];
        CHECK(std::abs(found.real() - value.real()) < 4 * error);
        CHECK(std::abs(found.imag() - value.imag()) < 4 * error);
        CHECK(error < 0.02 * std::abs(found));
      }
    }
}

TEST_CASE("nightly: 3D slabs: Monte Carlo agrees with transport to errors of 0.3 %") {
  for (const double g : {0.9, 0.98})
    for (const double optical_depth : {5.0, 20.0})
      for (const double albedo : {0.9, 1.0}) {
        constexpr double depth = 1000;
        const auto scene = tests::in_space(tests::hg_in_space(depth, optical_depth, g, albedo),
                                           tests::tilted_pairs(0, 0, {0, 1 / depth, 2 / depth}));
        tests::check_agreement(scene, false, g > 0.95 ? 16000000 : 6000000, 0.003);
      }
}

}  // namespace flatspeckle::mc::test_space_covariance
