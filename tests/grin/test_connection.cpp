#include <algorithm>
#include <limits>

#include <Eigen/Geometry>
#include <doctest/doctest.h>

#include "bench/scenes/random_fields.h"
#include "core/error.h"
#include "grin/media/fields/fisheye.h"
#include "grin/media/fields/gaussian_blobs.h"
#include "grin/media/fields/luneburg.h"
#include "grin/media/fields/parabolic.h"
#include "grin/rays/connections/connection_solver.h"
#include "tests/grin/connection_lists.h"

namespace flatspeckle::grin::test_connection {

using bench::random_direction;
using bench::random_point;
using oracles::HarmonicBall;
using oracles::HarmonicCurve;
using std::numbers::pi;
using tests::check_all_found;
using tests::everywhere;
using tests::Listed;
using tests::listed;

TEST_CASE(
    "connections in Luneburg's ball: the only curve between two points is found, closed form") {
  // Among the two ellipses and two senses, only the curve with cos sigma > 0 stays inside; within
  // the ball a ray takes a quarter of its period.
  const HarmonicBall field{{}};
  const Inside<bench::Ball> ball{{1}};
  RandomStream random(71, 0, 0);
  for (int i = 0; i < 100; ++i) {
    const Vec3 p = random_point(random, 1), q = random_point(random, 1);
    std::vector<HarmonicCurve> exact = oracles::harmonic_curves(p, q, 2 * pi);
    CHECK(exact.size() == 4);
    std::erase_if(exact, [](const HarmonicCurve& curve) { return curve.largest_radius() > 1; });
    CHECK(exact.size() == 1);
    check_all_found(listed(field, ball, p, q, {.step = 0.02, .max_length = 10}, 40, i), exact);
  }
}

TEST_CASE("connection: points without a curve between them give no curve and multiplicity 0") {
  const HarmonicBall field{{}};
  const Vec3 p(1.2, 0, 0), q(0, 1.2, 0);
  CHECK(oracles::harmonic_curves(p, q, 100).empty());
  const ConnectionTrial trial(field, everywhere, p, q, {.step = 0.05, .max_length = 8});
  ConnectionStatistics statistics;
  for (int i = 0; i < 200; ++i) {
    RandomStream random(73, 0, i);
    const ConnectionEstimate estimate = connect(trial, random, statistics);
    CHECK(!estimate.curve);
    CHECK(estimate.multiplicity == 0);
  }
  CHECK(statistics.found == 0);
  CHECK(statistics.trials() == 200);
}

TEST_CASE("connections past two lenses: curves come in mirrored pairs of equal length") {
  const GaussianBlobs lenses({{{0, 0.7, 0}, 1, 0.5}, {{0, -0.7, 0}, 1, 0.5}});
  const Listed list =
      listed(lenses, everywhere, {-2, 0, 0}, {2, 0, 0}, {.step = 0.05, .max_length = 7}, 1000, 1);
  REQUIRE(list.curves.size() == 7);
  for (const FoundConnection& one : list.curves) {
    const Vec3 mirrored = one.curve.start_direction.cwiseProduct(Vec3(1, -1, -1));
    const auto partner =
        std::find_if(list.curves.begin(), list.curves.end(), [&](const FoundConnection& other) {
          return (other.curve.start_direction - mirrored).norm() < 1e-6;
        });
    REQUIRE(partner != list.curves.end());
    CHECK(partner->curve.arc_length == doctest::Approx(one.curve.arc_length).epsilon(1e-8));
    CHECK(partner->curve.spreading == doctest::Approx(one.curve.spreading).epsilon(1e-5));
  }
}

TEST_CASE("connection to an image point: the continuum of curves is degenerate, and trials end") {
  const Fisheye field({.centre_excess = 0.7, .radius = 0.8});
  const Vec3 p(0.3, 0.2, -0.4);
  const Vec3 image = -0.64 / p.squaredNorm() * p;
  const ConnectionTrial trial(field, everywhere, p, image, {.step = 0.02, .max_length = 10});
  RandomStream random(75, 0, 0);
  ConnectionStatistics statistics;
  CHECK(all_connections(trial, 100, random, statistics).empty());
  CHECK(statistics.count(TrialOutcome::degenerate) > 80);
  const ConnectionEstimate estimate = connect(trial, random, statistics);
  CHECK(estimate.outcome == TrialOutcome::degenerate);
  CHECK(!estimate.curve);
}

TEST_CASE("connections in a fisheye: the two arcs of a great circle are found, closed form") {
  const Fisheye field({.centre_excess = 0.7, .radius = 0.8});
  const Vec3 p(0.3, 0.2, -0.4), q(-0.1, 0.5, 0.2);
  // both are arcs on a sphere of radius R = n0 a / 2, by stereographic projection, and wind again
  const Listed list = listed(field, everywhere, p, q, {.step = 0.02, .max_length = 8}, 100, 1);
  REQUIRE(list.curves.size() >= 2);
  const double whole = 2 * pi * 1.7 * 0.8 / 2;
  CHECK(list.curves[0].curve.optical_path + list.curves[1].curve.optical_path ==
        doctest::Approx(whole).epsilon(1e-6));
  CHECK(list.curves[0].curve.caustics == 0);
  CHECK(list.curves[1].curve.caustics == 2);
}

TEST_CASE(
    "connection of coinciding and close points: straight, in units from metres to micrometres") {
  const Vec3 p(0.3, 0.2, -0.4);
  for (const double unit : {1.0, 1e-6}) {
    CAPTURE(unit);
    const Fisheye field({.centre_excess = 0.7, .radius = 0.8 * unit});
    const ConnectionOptions options{.step = 0.05 * unit, .max_length = 2 * unit};
    const auto connected = [&](const Vec3& q) {
      return listed(field, everywhere, unit * p, unit * q, options, 50, 3);
    };
    CHECK(connected(p).statistics.count(TrialOutcome::degenerate) == 50);
    for (const double gap : {1e-9, 1e-6, 1e-3}) {
      CAPTURE(gap);
      const Vec3 to(0.6, -0.48, 0.64);
      const Listed list = connected(p + gap * to);
      REQUIRE(list.curves.size() >= 1);
      const Connection& curve = list.curves[0].curve;
      CHECK(curve.arc_length == doctest::Approx(gap * unit).epsilon(1e-5));
      CHECK(curve.spreading ==
            doctest::Approx(gap * gap * unit * unit).epsilon(1e-4 + gap).scale(0));
      CHECK((curve.start_direction - to).norm() < 1e-5 + gap);
    }
    CHECK(connected({-0.1, 0.5, 0.2}).curves.size() == 1);
    for (const double gap : {3e-12, 3e-11, 3e-10})  // never one curve counted as several
      CHECK(connected(p + gap * Vec3::UnitX()).curves.size() <= 1);
  }
}

TEST_CASE("connection in a homogeneous field: the straight line, without trials") {
  const Homogeneous glass{0.5};
  const Vec3 p(1, 2, 3), q(1, -1, 7);
  ConnectionOptions options{.step = 0.1, .max_length = 6};
  RandomStream random(76, 0, 0);
  ConnectionStatistics statistics;
  const auto connected = [&](const auto& region) {
    return connect(ConnectionTrial(glass, region, p, q, options), random, statistics);
  };
  const ConnectionEstimate estimate = connected(everywhere);
  REQUIRE(estimate.curve);
  CHECK(estimate.multiplicity == 1);
  CHECK(estimate.curve->spreading == doctest::Approx(25).epsilon(1e-15));
  CHECK(estimate.curve->optical_path == doctest::Approx(7.5).epsilon(1e-15));
  CHECK((estimate.curve->start_direction - Vec3(0, -0.6, 0.8)).norm() < 1e-15);
  CHECK(!connected([](const Vec3& x) { return x.z() < 4 || x.z() > 5; }).curve);
  options.max_length = 4.9;
  CHECK(connected(everywhere).outcome == TrialOutcome::too_long);
  CHECK(statistics.trials() == 0);
  CHECK(statistics.tangent_steps + statistics.guess_steps == 0);
  // the general solver agrees
  const GaussianBlobs flat({}, 0.5);
  const Listed list = listed(flat, everywhere, p, q, {.step = 1, .max_length = 6}, 50, 1);
  REQUIRE(list.curves.size() == 1);
  CHECK(list.curves[0].curve.spreading == doctest::Approx(25).epsilon(1e-12));
  CHECK(list.curves[0].curve.sigma == doctest::Approx(5 / 1.5).epsilon(1e-12));
}

TEST_CASE("connection in a weak field: the deflection is proportional to the field") {
  RandomStream random(77, 0, 0);
  const GaussianBlobs strong = bench::random_blobs(random, 1e-3);
  RandomStream again(77, 0, 0);
  const GaussianBlobs weak = bench::random_blobs(again, 1e-6);
  const Vec3 p(-1, 0.1, 0), q(1, 0.2, 0.1), chord = (q - p).normalized();
  const auto bend = [&](const GaussianBlobs& field) {
    const Listed list = listed(field, everywhere, p, q, {.step = 0.1, .max_length = 3}, 20, 1);
    REQUIRE(list.curves.size() == 1);
    return (list.curves[0].curve.start_direction - chord).norm();
  };
  CHECK(bend(strong) > 1e-5);
  CHECK(bend(weak) == doctest::Approx(1e-3 * bend(strong)).epsilon(0.02).scale(0));
}

TEST_CASE("connection trials: convergence does not depend on the number of steps") {
  const GaussianBlobs blob({{{0.05, 0, 5}, 0.005, 0.1}}, 0);
  const auto not_converged = [&](double step) {
    const ConnectionOptions options{.step = step, .max_length = 20};
    return listed(blob, everywhere, {0, 0, 0}, {0, 0, 10}, options, 30, 5)
        .statistics.count(TrialOutcome::not_converged);
  };
  CHECK(not_converged(5e-4) == not_converged(5e-3));
}

TEST_CASE("connection: curves that leave the region or are too long are rejected") {
  const HarmonicBall field{{}};
  const Vec3 p(0.9, 0, 0), q(0, 0.9, 0);
  const auto list = [&](const auto& region, double longest) {
    return listed(field, region, p, q, {.step = 0.05, .max_length = longest}, 100, 5);
  };
  CHECK(list(everywhere, 1.7).curves.size() == 1);
  CHECK(list(everywhere, 1.2).curves.empty());
  const auto wall = [](const Vec3& x) { return std::abs(x.x() - x.y()) > 0.2; };
  const Listed behind = list(wall, 1.7);
  CHECK(behind.curves.empty());
  CHECK(behind.statistics.count(TrialOutcome::converged) == 0);
  // endpoints may lie on the wall itself
  const auto strictly_inside = [](const Vec3& x) { return x.norm() < 0.9; };
  CHECK(list(strictly_inside, 3).curves.size() == 1);
}

TEST_CASE("connection: targets beyond all rays or without an index fail") {
  const ParabolicGuide guide({.axis_excess = 0.5, .alpha = 1});
  const Listed list = listed(guide, everywhere, Vec3(0.3, 0, 0), Vec3(2, 0, 1),
                             {.step = 0.1, .max_length = 20}, 50, 1);
  CHECK(list.curves.empty());
  const Listed outside = listed(guide, everywhere, Vec3(3, 0, 0), Vec3(0, 0, 1),
                                {.step = 0.1, .max_length = 20}, 50, 1);
  CHECK(outside.curves.empty());
}

TEST_CASE("connection statistics: sums do not depend on their order") {
  const HarmonicBall field{{}};
  const ConnectionTrial trial(field, everywhere, Vec3(0.3, 0.2, -0.4), Vec3(-0.1, 0.5, 0.2),
                              {.step = 0.2, .max_length = 6});
  std::array<ConnectionStatistics, 20> parts;
  for (std::size_t i = 0; i < parts.size(); ++i) {
    RandomStream random(78, 0, i);
    connect(trial, random, parts[i]);
  }
  ConnectionStatistics forward, backward;
  for (const auto& part : parts) forward += part;
  std::for_each(parts.rbegin(), parts.rend(), [&](const auto& part) { backward += part; });
  CHECK(forward.trials() == forward.pairs + forward.further);
  CHECK(forward.pairs == 20);
  CHECK(forward.outcomes == backward.outcomes);
  CHECK(forward.further == backward.further);
  CHECK(forward.most_trials_of_one == backward.most_trials_of_one);
  CHECK(forward.success_rate() > 0.5);
}

}  // namespace flatspeckle::grin::test_connection
