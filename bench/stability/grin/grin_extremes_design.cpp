// Derivatives of rays with respect to the coefficients of the field, and searches that cannot
// start.

#include <cmath>
#include <vector>

#include "bench/stability/extreme_rows.h"
#include "core/numbers/random.h"
#include "grin/design/adjoint/design_ray.h"
#include "grin/design/adjoint/measurement.h"
#include "grin/design/forms/field_form.h"
#include "grin/design/problem/designer.h"

namespace flatspeckle::bench {

namespace {

using namespace grin;
using namespace grin::design;

/// Returns random coefficients within 10 % of `strength`. With strength 1 a lens is nearly as
/// strong as Luneburg's.
std::vector<double> coefficients(std::size_t count, double strength) {
  RandomStream random(1, 2, 0);
  std::vector<double> all(count);
  for (double& c : all) c = strength * (1 + 0.2 * (random.uniform() - 0.5));
  return all;
}

/// A ray that enters a ball parallel to z at a given height, traced to its exit.
struct BallRay {
  BallForm form{Vec3::Zero(), 1, 7};
  double height, h;
  double strength = 0.4, difference = 1e-4;

  DesignRay ray() const {
    return {Vec3(height, 0, -std::sqrt(1 - height * height)), Vec3::UnitZ(), Sphere{}};
  }
  SurfaceMeasurement measurement() const { return {Vec3::UnitZ(), frame_across(Vec3::UnitZ())}; }
  RayWalk walk() const { return {h, static_cast<long>(100 / h)}; }
  std::vector<double> start() const { return coefficients(form.shape().size(), strength); }

  FollowedRay follow_in(const std::vector<double>& values) const {
    return follow<Pefrl>(form.field(values), ray(), walk());
  }
  /// Returns the error of the starting point after integrating back from the exit.
  double return_error() const {
    const auto field = form.field(start());
    const FollowedRay followed = follow_in(start());
    CoefficientSums<2> sums(shape_of(field));
    const RayState again = backpropagate<Pefrl>(field, ray(), walk(), followed,
                                                measurement()(followed.state).by, sums);
    return (again.x - ray().start).norm() + (again.v - ray().direction).norm();
  }
  /// Returns the relative error of the derivative of the exit point along one direction in the
  /// space of all coefficients, compared with fourth-order differences.
  double derivative_error() const {
    const auto values = start();
    const auto field = form.field(values);
    const FollowedRay followed = follow_in(values);
    CoefficientSums<2> sums(shape_of(field));
    backpropagate<Pefrl>(field, ray(), walk(), followed, measurement()(followed.state).by, sums);
    const auto along = [](std::size_t i) { return std::sin(static_cast<double>(i)); };
    double derivative = 0;
    sums.take([&](std::size_t i, const std::array<double, 2>& d) {
      derivative += strength * along(i) * d[0];
    });
    const auto end = [&](double by) {
      auto moved = values;
      for (std::size_t i = 0; i < moved.size(); ++i) moved[i] += by * strength * along(i);
      return measurement()(follow_in(moved).state).values[0];
    };
    const double step = difference;
    const double by_differences =
        (8 * (end(step) - end(-step)) - (end(2 * step) - end(-2 * step))) / (12 * step);
    return std::abs(derivative / by_differences - 1);
  }
};

DesignValues values_of(double start_excess, double step) {
  DesignValues values;
  values.form.nodes = {5};
  values.form.start_excess = start_excess;
  values.form.most_index = 50;
  values.step = step;
  auto& light = std::get<FocusValues>(values.design_target.kinds);
  light.directions = 4;
  light.rays_per_direction = 10;
  return values;
}

}  // namespace

void design_extremes(ExtremeRows& rows) {
  for (const double height : {0.1, 0.9, 0.9999})
    rows.add("derivative of a ray at " + short_number(height) + " of a ball's radius",
             "against differences", [=] {
               return Finding{BallRay{.height = height, .h = 0.05}.derivative_error(), 1e-8};
             });
  rows.add("derivative of a ray in an index of 1 + 1e-7", "against differences", [] {
    return Finding{
        BallRay{.height = 0.5, .h = 0.05, .strength = 1e-7, .difference = 0.5}.derivative_error(),
        1e-7};
  });
  rows.add("derivative of a ray by steps as long as the ball's radius", "against differences", [] {
    return Finding{BallRay{.height = 0.5, .h = 1}.derivative_error(), 1e-8};
  });
  rows.add("a ray of 20000 steps, walked back", "its start", [] {
    return Finding{BallRay{.height = 0.5, .h = 1e-4}.return_error(), 1e-12};
  });
  rows.add_refused("a search that starts where rays are trapped", "every ray must reach its end",
                   [] {
                     const DesignScene scene = make_design_scene(values_of(40, 0.5));
                     Designer(scene).begin();
                   });
}

}  // namespace flatspeckle::bench
