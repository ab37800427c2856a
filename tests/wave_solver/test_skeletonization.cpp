#include <algorithm>
#include <cmath>

#include <doctest/doctest.h>

#include "core/numbers/random.h"
#include "reference.h"
#include "wave_solver/equations/t_matrix_system.h"
#include "wave_solver/skeletons/interpolative.h"

namespace flatspeckle::wave::test_skeletonization {

TEST_CASE("proxy contour: goes around once at its distance, evenly spaced") {
  const Rectangle hull{{-1, 2}, {3, 2.5}};
  for (const double distance : {0.1, 0.7, 10.0}) {
    const double spacing = 0.05;
    const auto points = proxy_contour(hull, distance, spacing);
    double around = 0, area = 0;
    for (std::size_t i = 0; i < points.size(); ++i) {
      const Vec here = points[i], next = points[(i + 1) % points.size()];
      CHECK(hull.distance(here) == doctest::Approx(distance).epsilon(1e-12));
      CHECK(length(next - here) <= spacing * (1 + 1e-12));
      around += length(next - here);
      area += (here.x * next.z - here.z * next.x) / 2;
    }
    CHECK(around == doctest::Approx(9 + two_pi * distance).epsilon(3e-3));
    CHECK(std::abs(area) ==
          doctest::Approx(2 + 9 * distance + two_pi / 2 * distance * distance).epsilon(5e-3));
  }
}

// A box of 25 disks or 200 points among others: the skeleton must represent the equations of all
// others, near and far, not only those used for its choice.
TEST_CASE("skeletonization: the skeleton represents the coupling of its box to all others") {
  for (const bool disks : {false, true}) {
    Scatterer scatterer = disks ? reference_scatterer("TE15") : Scatterer{};
    scatterer.radius = disks ? 0.15 : 0;
    RandomStream random(11, 1, 0);
    Placement placement;
    const double apart = disks ? 0.42 : 0.15;
    const int from = disks ? -8 : -20, to = disks ? 13 : 34;
    for (int x = from; x < to; ++x)
      for (int z = from; z < to; ++z)
        placement.push_back(
            {{apart * x + 0.1 * random.uniform(), apart * z + 0.1 * random.uniform()}, scatterer});
    const TMatrixSystem system(placement, two_pi, disks ? 1e-4 : 1e-9);
    const Rectangle box{{0, 0}, {2.1, 2.1}};
    std::vector<std::size_t> inside, outside, near;
    for (std::size_t u = 0; u < system.unknowns(); ++u)
      (box.distance(placement[system.body_of(u)].position) == 0 ? inside : outside).push_back(u);
    Rectangle hull{{0, 0}, {2.1, 2.1}};
    if (disks) hull = {{-0.15, -0.15}, {2.25, 2.25}};
    for (const double tolerance : {1e-3, 1e-6, 1e-9}) {
      const Skeletonization skeletonization(system, tolerance);
      const ActiveBox active{hull, inside};
      const double distance = skeletonization.distance(active);
      near.clear();
      for (std::size_t u : outside)
        if (hull.distance(placement[system.body_of(u)].position) - scatterer.radius < distance)
          near.push_back(u);
      REQUIRE(near.size() > 20);
      REQUIRE(near.size() < outside.size() / 2);
      const auto found = skeletonization(active, near, RandomStream(1, 2, 3));
      CHECK(found.redundant.size() > inside.size() / 10);
      std::vector<Complex> m(outside.size() * inside.size());
      system.entries(outside, inside, m.data(), outside.size());
      double largest = 0;
      for (std::size_t r = 0; r < found.redundant.size(); ++r) {
        double square = 0;
        for (std::size_t i = 0; i < outside.size(); ++i) {
          Complex left = m[i + outside.size() * found.redundant[r]];
          for (std::size_t s = 0; s < found.skeleton.size(); ++s)
            left -=
                m[i + outside.size() * found.skeleton[s]] * found.t[r + found.redundant.size() * s];
          square += std::norm(left);
        }
        largest = std::max(largest, std::sqrt(square));
      }
      CAPTURE(disks);
      CAPTURE(tolerance);
      CHECK(largest < 5 * tolerance);
    }
  }
}

}  // namespace flatspeckle::wave::test_skeletonization
