#include <algorithm>
#include <limits>
#include <numeric>

#include <Eigen/Geometry>
#include <doctest/doctest.h>

#include "core/error.h"
#include "grin/connection_solver.h"
#include "grin/guides.h"
#include "grin/lenses.h"
#include "tests/grin/closed_fields.h"
#include "tests/grin/harmonic_curves.h"

namespace flatspeckle::grin {

using std::numbers::pi;
using tests::HarmonicBall;
using tests::HarmonicCurve;
using tests::random_direction;
using tests::random_point;

namespace {

constexpr WholeSpace everywhere;

struct Listed {
  std::vector<FoundConnection> curves;
  ConnectionStatistics statistics;
};

template <class Step = Sharma, IndexField F, Region R>
Listed listed(const F& field, const R& region, const Vec3& p, const Vec3& q,
              const ConnectionOptions& options, int trials, std::uint64_t seed) {
  const ConnectionTrial<F, R, Step> trial(field, region, p, q, options);
  RandomStream random(seed, 0, 0);
  Listed list;
  list.curves = all_connections(trial, trials, random, list.statistics);
  return list;
}

void check_curve(const Connection& found, const HarmonicCurve& exact) {
  CHECK(found.sigma == doctest::Approx(exact.sigma).epsilon(1e-6));
  CHECK(found.arc_length == doctest::Approx(exact.arc_length()).epsilon(1e-6));
  CHECK(found.optical_path == doctest::Approx(exact.optical_path()).epsilon(1e-6));
  CHECK((found.start_direction - exact.v0.normalized()).norm() < 1e-5);
  CHECK((found.end_direction - exact.v(exact.sigma).normalized()).norm() < 1e-5);
  CHECK(found.spreading == doctest::Approx(exact.spreading()).epsilon(1e-4));
  CHECK(found.caustics == exact.caustics());
  CHECK(found.orientation == (exact.caustics() % 2 ? -1 : 1));
}

/// All of them, and no others.
void check_all_found(const Listed& list, std::vector<HarmonicCurve> exact) {
  std::sort(exact.begin(), exact.end(), [](const HarmonicCurve& a, const HarmonicCurve& b) {
    return a.optical_path() < b.optical_path();
  });
  REQUIRE(list.curves.size() == exact.size());
  for (std::size_t i = 0; i < exact.size(); ++i) check_curve(list.curves[i].curve, exact[i]);
}

}  // namespace

TEST_CASE("in Luneburg's ball one curve joins any two points, and it is found") {
  // Of the two ellipses and two ways round, that with cos sigma > 0 stays inside (the others leave
  // the ball: within it a ray takes a quarter of its period).
  const HarmonicBall field{{}};
  const Inside<tests::Ball> ball{{1}};
  RandomStream random(71, 0, 0);
  for (int i = 0; i < 100; ++i) {
    const Vec3 p = random_point(random, 1), q = random_point(random, 1);
    std::vector<HarmonicCurve> exact = tests::harmonic_curves(p, q, 2 * pi);
    CHECK(exact.size() == 4);
    std::erase_if(exact, [](const HarmonicCurve& curve) { return curve.largest_radius() > 1; });
    CHECK(exact.size() == 1);
    check_all_found(listed(field, ball, p, q, {.step = 0.02, .max_length = 10}, 40, i), exact);
  }
}

TEST_CASE("without the rim two ellipses join two points, each both ways round, again and again") {
  const HarmonicBall field{{}};
  RandomStream random(72, 0, 0);
  int pairs = 0;
  for (int i = 0; pairs < 20 && i < 1000; ++i) {
    const Vec3 p = random_point(random, 1), q = random_point(random, 1);
    std::vector<HarmonicCurve> exact = tests::harmonic_curves(p, q, 6 * pi);
    const double longest = 8;
    // the index is 0 at r = sqrt 2, where steps of this length end; and curves as long as the
    // longest may count or not
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
  CHECK(pairs == 20);
}

TEST_CASE("a pair that no curve joins gives none, and 0") {
  const HarmonicBall field{{}};
  const Vec3 p(1.2, 0, 0), q(0, 1.2, 0);
  CHECK(tests::harmonic_curves(p, q, 100).empty());
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

TEST_CASE("curves there are the curves back: same length and path, n_P^2/|J_PQ| = n_Q^2/|J_QP|") {
  int curves = 0;
  for (int i = 0; i < 12; ++i) {
    RandomStream random(74, 0, i);
    const SplineField field = tests::random_spline(random, 0.15);
    const Inside<tests::Ball> ball{{1.2}};
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

TEST_CASE("a continuum of curves is degenerate: nothing is found and nothing runs for ever") {
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

TEST_CASE("in the fisheye the two arcs of a great circle join two points") {
  const Fisheye field({.centre_excess = 0.7, .radius = 0.8});
  const Vec3 p(0.3, 0.2, -0.4), q(-0.1, 0.5, 0.2);
  // on a sphere of radius R = n0 a / 2, by stereographic projection; both go round it again
  const Listed list = listed(field, everywhere, p, q, {.step = 0.02, .max_length = 8}, 100, 1);
  REQUIRE(list.curves.size() >= 2);
  const double whole = 2 * pi * 1.7 * 0.8 / 2;
  CHECK(list.curves[0].curve.optical_path + list.curves[1].curve.optical_path ==
        doctest::Approx(whole).epsilon(1e-6));
  CHECK(list.curves[0].curve.caustics == 0);
  CHECK(list.curves[1].curve.caustics == 2);
}

TEST_CASE("points that coincide, or nearly, from a scene of metres down to micrometres") {
  const Vec3 p(0.3, 0.2, -0.4);
  for (const double unit : {1.0, 1e-6}) {
    CAPTURE(unit);
    const Fisheye field({.centre_excess = 0.7, .radius = 0.8 * unit});
    const ConnectionOptions options{.step = 0.05 * unit, .max_length = 2 * unit};
    const auto joined = [&](const Vec3& q) {
      return listed(field, everywhere, unit * p, unit * q, options, 50, 3);
    };
    CHECK(joined(p).statistics.count(TrialOutcome::degenerate) == 50);
    for (const double gap : {1e-9, 1e-6, 1e-3}) {
      CAPTURE(gap);
      const Vec3 to(0.6, -0.48, 0.64);
      const Listed list = joined(p + gap * to);
      REQUIRE(list.curves.size() >= 1);
      const Connection& curve = list.curves[0].curve;
      CHECK(curve.arc_length == doctest::Approx(gap * unit).epsilon(1e-5));
      CHECK(curve.spreading ==
            doctest::Approx(gap * gap * unit * unit).epsilon(1e-4 + gap).scale(0));
      CHECK((curve.start_direction - to).norm() < 1e-5 + gap);
    }
    CHECK(joined({-0.1, 0.5, 0.2}).curves.size() == 1);
  }
}

TEST_CASE("in a homogeneous field the straight line is the curve, and no trial runs") {
  const Homogeneous glass{0.5};
  const Vec3 p(1, 2, 3), q(1, -1, 7);
  ConnectionOptions options{.step = 0.1, .max_length = 6};
  RandomStream random(76, 0, 0);
  ConnectionStatistics statistics;
  const auto joined = [&](const auto& region) {
    return connect(ConnectionTrial(glass, region, p, q, options), random, statistics);
  };
  const ConnectionEstimate estimate = joined(everywhere);
  REQUIRE(estimate.curve);
  CHECK(estimate.multiplicity == 1);
  CHECK(estimate.curve->spreading == doctest::Approx(25).epsilon(1e-15));
  CHECK(estimate.curve->optical_path == doctest::Approx(7.5).epsilon(1e-15));
  CHECK((estimate.curve->start_direction - Vec3(0, -0.6, 0.8)).norm() < 1e-15);
  CHECK(!joined([](const Vec3& x) { return x.z() < 4 || x.z() > 5; }).curve);
  options.max_length = 4.9;
  CHECK(joined(everywhere).outcome == TrialOutcome::too_long);
  CHECK(statistics.trials() == 0);
  CHECK(statistics.tangent_steps + statistics.guess_steps == 0);
  // the solver itself, told nothing, agrees
  const GaussianBlobs flat({}, 0.5);
  const Listed list = listed(flat, everywhere, p, q, {.step = 1, .max_length = 6}, 50, 1);
  REQUIRE(list.curves.size() == 1);
  CHECK(list.curves[0].curve.spreading == doctest::Approx(25).epsilon(1e-12));
  CHECK(list.curves[0].curve.sigma == doctest::Approx(5 / 1.5).epsilon(1e-12));
}

TEST_CASE("an almost invisible field bends by as much as it should") {
  RandomStream random(77, 0, 0);
  const GaussianBlobs strong = tests::random_blobs(random, 1e-3);
  RandomStream again(77, 0, 0);
  const GaussianBlobs weak = tests::random_blobs(again, 1e-6);
  const Vec3 p(-1, 0.1, 0), q(1, 0.2, 0.1), chord = (q - p).normalized();
  const auto bend = [&](const GaussianBlobs& field) {
    const Listed list = listed(field, everywhere, p, q, {.step = 0.1, .max_length = 3}, 20, 1);
    REQUIRE(list.curves.size() == 1);
    return (list.curves[0].curve.start_direction - chord).norm();
  };
  CHECK(bend(strong) > 1e-5);
  CHECK(bend(weak) == doctest::Approx(1e-3 * bend(strong)).epsilon(0.02).scale(0));
}

TEST_CASE("walls and lengths: a curve that leaves the region or is too long is none") {
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
  // the ends may lie on the wall itself
  const auto strictly_inside = [](const Vec3& x) { return x.norm() < 0.9; };
  CHECK(list(strictly_inside, 3).curves.size() == 1);
}

TEST_CASE("a target where no ray can be, or no index, ends as a failure") {
  const ParabolicGuide guide({.axis_excess = 0.5, .alpha = 1});
  const Listed list = listed(guide, everywhere, Vec3(0.3, 0, 0), Vec3(2, 0, 1),
                             {.step = 0.1, .max_length = 20}, 50, 1);
  CHECK(list.curves.empty());
  const Listed outside = listed(guide, everywhere, Vec3(3, 0, 0), Vec3(0, 0, 1),
                                {.step = 0.1, .max_length = 20}, 50, 1);
  CHECK(outside.curves.empty());
}

TEST_CASE("statistics add up, in any order") {
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
  CHECK(forward.trials() == forward.pairs + forward.refind);
  CHECK(forward.pairs == 20);
  CHECK(forward.outcomes == backward.outcomes);
  CHECK(forward.refind_counts == backward.refind_counts);
  CHECK(std::accumulate(forward.refind_counts.begin(), forward.refind_counts.end(), 0ul) ==
        forward.found);
  CHECK(forward.refind_max == backward.refind_max);
  CHECK(forward.success_rate() > 0.5);
}

TEST_CASE("options that make no sense are refused") {
  const ConnectionOptions good{.step = 0.1, .max_length = 1};
  CHECK_NOTHROW(check(good));
  const auto refused = [&](auto change) {
    ConnectionOptions bad = good;
    change(bad);
    CHECK_THROWS_AS(check(bad), InputError);
  };
  refused([](auto& o) { o.step = 0; });
  refused([](auto& o) { o.max_length = std::numeric_limits<double>::infinity(); });
  refused([](auto& o) { o.start.chord_share = 1; });
  refused([](auto& o) { o.start.cosine = 1; });
  refused([](auto& o) { o.roulette_after = 0; });
  refused([](auto& o) { o.tolerance = std::numeric_limits<double>::quiet_NaN(); });
}

}  // namespace flatspeckle::grin
