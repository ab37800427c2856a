#include "grin/rays/connections/geometric_spreading.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Geometry>

namespace flatspeckle::grin {

namespace {

// Ratio of the two singular values of a transverse map below which its determinant consists of
// rounding errors.
constexpr double rounding = 1e-13;

/// Returns the number of caustics between two points with the transverse maps `before` and `after`:
/// the number of negative eigenvalues of the matrix after before^-1.
int crossings(const Mat2& before, const Mat2& after) {
  Mat2 adjugate;
  adjugate << before(1, 1), -before(0, 1), -before(1, 0), before(0, 0);
  const double sign = before.determinant();
  if ((sign < 0) != (after.determinant() < 0)) return 1;
  return (after * adjugate).trace() * sign < 0 ? 2 : 0;
}

}  // namespace

Widths widths(const Mat2& map) {
  const double determinant = std::abs(map.determinant());
  const double sum = std::sqrt(map.squaredNorm() + 2 * determinant);
  const double difference = std::sqrt(std::max(0.0, map.squaredNorm() - 2 * determinant));
  const double wide = (sum + difference) / 2;
  return {wide > 0 ? determinant / wide : 0, wide};
}

void CausticCount::pass(const RayState& ray, const RayTangent& tangent) {
  here_ = carried_across(here_, ray.v);
  const Mat2 map = transverse_map(tangent, n_start_, start_, here_);
  const auto [narrow, wide] = widths(map);
  widest_ = std::max(widest_, wide);
  // A point on a caustic is skipped: the points before and after it are compared instead
  if (narrow < rounding * widest_) return;
  count_ += crossings(before_, map);
  before_ = map;
}

}  // namespace flatspeckle::grin
