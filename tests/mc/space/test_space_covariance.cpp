#include <array>
#include <chrono>
#include <cstdio>

#include <doctest/doctest.h>

#include "mc/space/space_flux.h"
#include "tests/mc/space/slabs_in_space.h"

namespace flatspeckle::mc {

namespace {

using std::numbers::pi;
using tests::against_first;
using tests::downward;
using tests::hg_space;

constexpr double depth = 2000;

/// Light and view along the normal: the intensity, then C_I at tilts of q L.
std::vector<double> memory_effect(const SpaceSlab& slab, const std::vector<double>& turns,
                                  double tolerance) {
  std::vector<Eigen::Vector3d> lights{downward(0, 0)};
  for (const double turn : turns) lights.push_back(downward(turn / (slab.k * slab.depth), 0));
  const auto t0 = std::chrono::steady_clock::now();
  const auto found = space_covariance(slab, against_first(lights, lights), false, {tolerance});
  const std::size_t n = turns.size();
  std::vector<double> values{found.value[n].real()};
  for (std::size_t i = 0; i < n; ++i)
    values.push_back(std::norm(found.value[i]) / found.value[n].real() /
                     found.value[n + 1 + i].real());
  std::printf("ordinates %d, %.3f s:", found.ordinates,
              std::chrono::duration<double>(std::chrono::steady_clock::now() - t0).count());
  for (auto v : values) std::printf(" %.8f", v);
  std::printf("\n");
  return values;
}

}  // namespace

TEST_CASE("slabs in space: known intensities and correlations") {
  const auto check = [](double g, const std::array<double, 4>& known) {
    const auto found = memory_effect(hg_space(depth, 10, g, 1), {1.2, 1.4, 1.6}, 1e-5);
    CHECK(std::abs(found[0] / known[0] - 1) < 1e-4);
    for (std::size_t i = 1; i < 4; ++i) CHECK(std::abs(found[i] - known[i]) < 1e-4);
  };
  check(0, {0.058862, 0.5923, 0.4977, 0.4106});
  check(0.5, {0.10584, 0.5627, 0.4675, 0.3820});
}

TEST_CASE("flux") {
  const auto slab = hg_space(2, 2, 0.75, 0.9);
  const auto f = space_flux(slab, 0, {1e-8});
  std::printf("%.8f %.8f %g\n", f.reflected, f.transmitted + std::exp(-2.), f.difference);
}

TEST_CASE("speed") {
  for (double g : {0., .9, .98})
    for (double tol : {1e-3, 1e-4}) {
      std::vector<double> t;
      for (int i = 1; i <= 4; ++i) t.push_back(i);
      memory_effect(hg_space(depth, 10, g, 1), t, tol);
    }
}

}  // namespace flatspeckle::mc
