#include <algorithm>
#include <cmath>
#include <vector>

#include <Eigen/Geometry>
#include <doctest/doctest.h>

#include "bench/scenes/random_fields.h"
#include "tests/grin/connection_lists.h"
#include "tests/statistics.h"

namespace flatspeckle::grin::test_connection_lists {

using bench::random_direction;
using bench::random_point;
using flatspeckle::tests::is_night;
using oracles::HarmonicBall;
using oracles::HarmonicCurve;
using std::numbers::pi;
using tests::check_all_found;
using tests::everywhere;
using tests::Listed;
using tests::listed;

TEST_CASE(
    "connections without the rim: both senses and all windings of two ellipses are found, closed "
    "form") {
  const HarmonicBall field{{}};
  RandomStream random(72, 0, 0);
  int pairs = 0;
  const int most_pairs = is_night ? 20 : 4;
  for (int i = 0; pairs < most_pairs && i < 1000; ++i) {
    const Vec3 p = random_point(random, 1), q = random_point(random, 1);
    std::vector<HarmonicCurve> exact = oracles::harmonic_curves(p, q, 6 * pi);
    const double longest = 8;
    // near r = sqrt 2 the index is 0 and steps of this length fail; curves as long as the limit may
    // or may not be found
    const auto awkward = [&](const HarmonicCurve& curve) {
      return curve.x0.cross(curve.v0).norm() < 0.5 || curve.spreading() < 1e-3 ||
             std::abs(curve.arc_length() - longest) < 1e-3;
    };
    if (std::any_of(exact.begin(), exact.end(), awkward)) continue;
    ++pairs;
    std::erase_if(exact, [&](const HarmonicCurve& c) { return c.arc_length() > longest; });
    CHECK(exact.size() >= 4);
    check_all_found(listed(field, everywhere, p, q, {.step = 0.02, .max_length = longest}, 500, i),
                    exact);
  }
  CHECK(pairs == most_pairs);
}

TEST_CASE("connections are reciprocal: same curves both ways, n_P^2/|J_PQ| = n_Q^2/|J_QP|") {
  int curves = 0;
  for (int i = 0; i < 12; ++i) {
    RandomStream random(74, 0, i);
    const SplineField field = bench::random_spline(random, 0.15);
    const Inside<bench::Ball> ball{{1.2}};
    const Vec3 p = random_point(random, 0.9), q = random_point(random, 0.9);
    const ConnectionOptions options{.step = 2e-3, .max_length = 4};
    const Listed there = listed<Yoshida4>(field, ball, p, q, options, 60, 2 * i);
    const Listed back = listed<Yoshida4>(field, ball, q, p, options, 60, 2 * i + 1);
    REQUIRE(there.curves.size() == back.curves.size());
    const double ratio = std::pow(index(field, p) / index(field, q), 2);
    for (std::size_t k = 0; k < there.curves.size(); ++k) {
      const Connection &a = there.curves[k].curve, &b = back.curves[k].curve;
      CHECK((a.start_direction + b.end_direction).norm() < 1e-7);
      CHECK((a.end_direction + b.start_direction).norm() < 1e-7);
      CHECK(a.optical_path == doctest::Approx(b.optical_path).epsilon(1e-9));
      CHECK(a.spreading == doctest::Approx(ratio * b.spreading).epsilon(1e-8).scale(0));
      CHECK(a.caustics == b.caustics);
      ++curves;
    }
  }
  CHECK(curves >= 12);
}

TEST_CASE("connections among lenses are complete: the orientations of all curves add up to 1") {
  // The endpoints of long rays cover space once, counted with the sign of J, like those of straight
  // rays; gravitational lenses form an odd number of images for this reason.
  std::size_t most = 0;
  for (int i = 0; i < (is_night ? 10 : 3); ++i) {
    RandomStream random(79, 0, i);
    std::vector<GaussianBlob> lenses;
    for (int k = 0; k < 4; ++k) lenses.push_back({random_point(random, 1), 0.8, 0.4});
    const Vec3 p = 2.5 * random_direction(random), q = -p + random_point(random, 0.3);
    const Listed list =
        listed(GaussianBlobs(lenses), everywhere, p, q, {.step = 0.05, .max_length = 9}, 2000, i);
    int sum = 0;
    for (const FoundConnection& one : list.curves) sum += one.curve.orientation;
    CHECK(sum == 1);
    most = std::max(most, list.curves.size());
  }
  CHECK(most >= (is_night ? 5 : 3));
}

}  // namespace flatspeckle::grin::test_connection_lists
