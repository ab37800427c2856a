// Pairs of points connected by one curve, by several, by a continuum, or by none.

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include <Eigen/Geometry>

#include "bench/oracles/harmonic_ball.h"
#include "bench/scenes/random_fields.h"
#include "bench/stability/extreme_rows.h"
#include "grin/media/fields/fisheye.h"
#include "grin/media/fields/gaussian_blobs.h"
#include "grin/media/fields/luneburg.h"
#include "grin/media/fields/parabolic.h"
#include "grin/media/fields/tanh_ramp.h"
#include "grin/rays/connections/connection_solver.h"
#include "grin/rays/marching/ray_step.h"
#include "grin/trace/trace_scene.h"

namespace flatspeckle::bench {

namespace {

using namespace grin;
using oracles::HarmonicBall;
using oracles::HarmonicCurve;
using std::numbers::pi;
constexpr double infinity = std::numeric_limits<double>::infinity();
const WholeSpace everywhere;

struct Listed {
  std::vector<FoundConnection> curves;
  ConnectionStatistics statistics;
};
template <class Step = Sharma, grin::IndexField F, Region R>
Listed listed(const F& field, const R& region, const Vec3& p, const Vec3& q,
              const ConnectionOptions& options, int trials) {
  const ConnectionTrial<F, R, Step> trial(field, region, p, q, options);
  RandomStream random(1, 0, 0);
  Listed list;
  list.curves = all_connections(trial, trials, random, list.statistics);
  return list;
}

const HarmonicBall ball{{}};
const Fisheye eye({.centre_excess = 0.7, .radius = 0.8});
const Vec3 ball_from(0.3, 0.2, -0.4), ball_to(-0.1, 0.5, 0.2);

/// Returns the four curves of arc length up to 6: two ellipses, each traversed in both senses.
std::vector<HarmonicCurve> four_curves() {
  auto curves = oracles::harmonic_curves(ball_from, ball_to, 6 * pi);
  std::erase_if(curves, [](const HarmonicCurve& c) { return c.arc_length() > 6; });
  std::sort(curves.begin(), curves.end(), [](const HarmonicCurve& a, const HarmonicCurve& b) {
    return a.optical_path() < b.optical_path();
  });
  return curves;
}

Finding all_four() {
  const auto exact = four_curves();
  const Listed list =
      listed(ball, everywhere, ball_from, ball_to, {.step = 0.02, .max_length = 6}, 300);
  if (list.curves.size() != exact.size()) return {infinity, 1e-5};
  double worst = 0;
  for (std::size_t i = 0; i < exact.size(); ++i) {
    const Connection& found = list.curves[i].curve;
    worst = larger({worst, std::abs(found.optical_path / exact[i].optical_path() - 1),
                    std::abs(found.spreading / exact[i].spreading() - 1),
                    std::abs(found.caustics - 1.0 * exact[i].caustics())});
  }
  return {worst, 1e-5};
}

/// Compares the estimate f K of C26 with the sum over the four curves, f = 1/|J|.
Finding sum_of_four() {
  double exact = 0;
  for (const HarmonicCurve& curve : four_curves()) exact += 1 / curve.spreading();
  const ConnectionTrial trial(ball, everywhere, ball_from, ball_to,
                              {.step = 0.2, .max_length = 6, .start = {.chord_share = 0.1}});
  ConnectionStatistics statistics;
  const auto estimate = [&](int i) {
    RandomStream random(2, 0, i);
    const auto one = connect(trial, random, statistics);
    return one.curve ? one.multiplicity / one.curve->spreading : 0;
  };
  return mean_in_errors(3000, estimate, exact, 0.1);
}

/// Checks two points that no ellipse connects.
Finding none() {
  const ConnectionTrial trial(ball, everywhere, Vec3(1.2, 0, 0), Vec3(0, 1.2, 0),
                              {.step = 0.05, .max_length = 8});
  ConnectionStatistics statistics;
  double sum = 0;
  for (int i = 0; i < 100; ++i) {
    RandomStream random(3, 0, i);
    sum += connect(trial, random, statistics).multiplicity;
  }
  return {sum, 0};
}

/// Checks a point and its image in a fisheye: all rays connect them with |J| = 0, so no connection
/// is counted.
Finding continuum() {
  const Vec3 image = -0.64 / ball_from.squaredNorm() * ball_from;
  const Listed list =
      listed(eye, everywhere, ball_from, image, {.step = 0.02, .max_length = 10}, 50);
  return {static_cast<double>(list.curves.size()) +
              (list.statistics.count(TrialOutcome::degenerate) < 40 ? 1 : 0),
          0};
}

/// Checks the two connections in a fisheye, which correspond to the two arcs of a great circle.
Finding great_circle() {
  const Listed list =
      listed(eye, everywhere, ball_from, ball_to, {.step = 0.02, .max_length = 8}, 100);
  if (list.curves.size() < 2) return {infinity, 1e-6};
  const double whole = 2 * pi * 1.7 * 0.8 / 2;
  const double paths = list.curves[0].curve.optical_path + list.curves[1].curve.optical_path;
  return {std::abs(paths / whole - 1), 1e-6};
}

/// Checks |J| = distance^2 at tiny distances, in units of 1 or 1e-6.
Finding close_points(double gap, double unit) {
  const Fisheye field({.centre_excess = 0.7, .radius = 0.8 * unit});
  const Vec3 to(0.6, -0.48, 0.64);
  const Listed list = listed(field, everywhere, unit * ball_from, unit * (ball_from + gap * to),
                             {.step = 0.05 * unit, .max_length = 2 * unit}, 30);
  if (list.curves.empty()) return {infinity, 1e-4};
  const Connection& curve = list.curves[0].curve;
  // rounding gives the difference of the points a relative error of 1e-16 / gap
  return {larger(std::abs(curve.spreading / std::pow(gap * unit, 2) - 1),
                 (curve.start_direction - to).norm()),
          1e-4};
}

Finding same_point() {
  const Listed list =
      listed(eye, everywhere, ball_from, ball_from, {.step = 0.05, .max_length = 1}, 30);
  return {static_cast<double>(list.curves.size()), 0};
}

/// Checks that the orientations (signs of J) of all connections add up to 1: counted with this
/// sign, the endpoints of long rays cover space once.
Finding lenses() {
  const GaussianBlobs field({{{0, 0.7, 0}, 1, 0.5}, {{0, -0.7, 0}, 1, 0.5}});
  const Listed list =
      listed(field, everywhere, {-2, 0, 0}, {2, 0, 0}, {.step = 0.05, .max_length = 7}, 600);
  int sum = 0;
  for (const FoundConnection& one : list.curves) sum += one.curve.orientation;
  return {list.curves.size() < 3 ? infinity : std::abs(sum - 1.0), 0};
}

/// Checks that rays bend a thousand times less for n - 1 = 1e-6 than for 1e-3, to the second order
/// of the latter.
Finding faint_bend() {
  const Vec3 p(-1, 0.1, 0), q(1, 0.2, 0.1), chord = (q - p).normalized();
  const auto bend = [&](double height) {
    RandomStream random(77, 0, 0);
    const GaussianBlobs field = random_blobs(random, height);
    const Listed list = listed(field, everywhere, p, q, {.step = 0.1, .max_length = 3}, 20);
    return list.curves.size() == 1 ? (list.curves[0].curve.start_direction - chord).norm()
                                   : infinity;
  };
  return {std::abs(bend(1e-6) / (1e-3 * bend(1e-3)) - 1), 0.02};
}

/// Checks connections within a dense layer: a straight ray, and a ray totally reflected by a steep
/// ramp of the index. Except for the width of the ramp, the latter is the straight line to the
/// mirror image.
Finding total_reflection() {
  const TanhRamp ramp{0.5, 0, 0.01};
  const Vec3 p(0, 0, -0.5), q(2, 0, -0.5);
  const auto dense = [](const Vec3& x) { return x[2] < 0.05; };
  const Listed list = listed(ramp, dense, p, q, {.step = 2e-3, .max_length = 3}, 400);
  if (list.curves.size() != 2) return {infinity, 0.02};
  const double line = 1.5 * 2, mirrored = 1.5 * std::hypot(2, 1);
  return {larger(std::abs(list.curves[0].curve.optical_path / line - 1),
                 std::abs(list.curves[1].curve.optical_path / mirrored - 1)),
          0.02};
}

/// Checks the reciprocity n_P^2 / |J_PQ| = n_Q^2 / |J_QP| in a spline field with strong variations.
Finding there_and_back() {
  RandomStream random(74, 0, 0);
  const SplineField field = random_spline(random, 0.15);
  const Inside<Ball> region{{1.2}};
  const Vec3 p = random_point(random, 0.9), q = random_point(random, 0.9);
  const ConnectionOptions options{.step = 2e-3, .max_length = 4};
  const Listed there = listed<Yoshida4>(field, region, p, q, options, 30),
               back = listed<Yoshida4>(field, region, q, p, options, 30);
  if (there.curves.empty() || there.curves.size() != back.curves.size()) return {infinity, 1e-7};
  const double ratio = std::pow(index(field, p) / index(field, q), 2);
  double worst = 0;
  for (std::size_t i = 0; i < there.curves.size(); ++i)
    worst = larger(
        worst,
        std::abs(there.curves[i].curve.spreading / (ratio * back.curves[i].curve.spreading) - 1));
  return {worst, 1e-7};
}

/// Checks that there are no connections beyond rho = 1.5, where the index is undefined.
Finding no_index() {
  const ParabolicGuide guide({.axis_excess = 0.5, .alpha = 1});
  const ConnectionOptions options{.step = 0.1, .max_length = 20};
  const auto to = listed(guide, everywhere, Vec3(0.3, 0, 0), Vec3(2, 0, 1), options, 50);
  const auto from = listed(guide, everywhere, Vec3(3, 0, 0), Vec3(0, 0, 1), options, 50);
  return {static_cast<double>(to.curves.size() + from.curves.size()), 0};
}

}  // namespace

void connection_extremes(ExtremeRows& rows) {
  rows.add("four curves between two points of Luneburg's ball", "paths, |J|, caustics", all_four);
  rows.add("four curves, one drawn at a time", "sum of 1/|J|, in errors", sum_of_four);
  rows.add("points of Luneburg's ball without connecting curve", "nothing found", none);
  rows.add("a point of the fisheye and its image: a continuum", "degenerate, none counts",
           continuum);
  rows.add("two points of the fisheye", "a great circle's two arcs", great_circle);
  for (const double unit : {1.0, 1e-6})
    for (const double gap : {1e-9, 1e-6})
      rows.add("points " + short_number(gap) + " apart, unit of length " + short_number(unit),
               "|J| = distance^2", close_points, gap, unit);
  rows.add("a point and itself", "degenerate, none counts", same_point);
  rows.add("two strong lenses, seven curves", "sum of orientations 1", lenses);
  rows.add("blobs of n - 1 = 1e-6", "bend proportional to n - 1", faint_bend);
  rows.add("steep ramp beyond the critical angle: two curves", "straight, mirrored",
           total_reflection);
  rows.add("rough spline of 0.15", "n_P^2 / |J_PQ| = n_Q^2 / |J_QP|", there_and_back);
  rows.add("ends beyond the index of a guide", "nothing found", no_index);
  rows.add_refused("steps of length 0", "step", [] {
    TraceValues values;
    values.curves.connect = {0, 0, 0, 0, 0, 1};
    values.stops.max_length = 1;
    values.stops.step = 0;
    make_trace_scene(values);
  });
}

}  // namespace flatspeckle::bench
