#pragma once

#include <Eigen/LU>

#include "grin/media/geometry/frame.h"
#include "grin/rays/marching/ray.h"

namespace flatspeckle::grin {

using Mat2 = Eigen::Matrix2d;

/// Where the ray goes across itself as its start direction turns, length per radian:
/// n_P E_Q^T (dx/dv0) E_P, the 2 x 2 map whose determinant is C25's.
inline Mat2 transverse_map(const RayTangent& tangent, double n_start, const Frame& start,
                           const Frame& end) {
  return n_start * (end.transpose() * tangent.dx * start);
}

/// J_PQ (conventions, C25) with its sign: area across the ray at Q per solid angle at P. It is
/// negative after an odd number of caustics; |J| replaces the r^2 of straight rays, and
/// n_P^2 / |J_PQ| = n_Q^2 / |J_QP|.
inline double signed_spreading(const RayTangent& tangent, double n_start, const Vec3& start,
                               const Vec3& end) {
  return transverse_map(tangent, n_start, frame_across(start), frame_across(end)).determinant();
}

/// The smaller and the larger singular value.
struct Widths {
  double narrow, wide;
};
Widths widths(const Mat2& map);

/// Counts the caustics that a ray passes, each as often as its rank falls (the Maslov index): a
/// line focus once, a point focus twice, which leaves no change of sign in the determinant. It is
/// told the transverse map at points so close that the map turns by less than a right angle.
class CausticCount {
 public:
  /// n_start as for transverse_map; the ray starts along `direction`.
  CausticCount(double n_start, const Vec3& direction)
      : n_start_(n_start), start_(frame_across(direction)), here_(start_) {}

  void pass(const RayState& ray, const RayTangent& tangent);
  int count() const { return count_; }
  /// The larger singular value where it was largest on the way.
  double widest() const { return widest_; }

 private:
  double n_start_;
  Frame start_, here_;
  Mat2 before_ = Mat2::Identity();  // a ray starts with distance times the unit map
  int count_ = 0;
  double widest_ = 0;
};

}  // namespace flatspeckle::grin
