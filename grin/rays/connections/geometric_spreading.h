#pragma once

#include <Eigen/LU>

#include "grin/media/geometry/frame.h"
#include "grin/rays/marching/ray.h"

namespace flatspeckle::grin {

using Mat2 = Eigen::Matrix2d;

/// Returns the transverse map, a 2 x 2 matrix: the displacement of the end of a ray from P to Q per
/// radian of its start direction, perpendicular to the ray. It is n_P E_Q^T (dx/dv0) E_P, where n_P
/// is the index at P and E_P and E_Q are the frames at P and Q. Its determinant is J_PQ
/// (conventions, C25).
inline Mat2 transverse_map(const RayTangent& tangent, double n_start, const Frame& start,
                           const Frame& end) {
  return n_start * (end.transpose() * tangent.dx * start);
}

/// Returns J_PQ (conventions, C25) with its sign: the area perpendicular to the ray at Q per solid
/// angle at P. J_PQ is negative after an odd number of caustics; |J| replaces the r^2 of straight
/// rays, and n_P^2 / |J_PQ| = n_Q^2 / |J_QP|.
inline double signed_spreading(const RayTangent& tangent, double n_start, const Vec3& start,
                               const Vec3& end) {
  return transverse_map(tangent, n_start, frame_across(start), frame_across(end)).determinant();
}

/// The smaller and the larger singular value of a transverse map: widths of a beam per radian.
struct Widths {
  double narrow, wide;
};
Widths widths(const Mat2& map);

/// Counts the caustics that a ray passes (the Maslov index). A caustic counts as the amount by
/// which it lowers the rank of the transverse map: 1 for a line focus, 2 for a point focus. A point
/// focus does not change the sign of the determinant. Successive calls of pass() must be so close
/// that the map turns by less than a right angle between them.
class CausticCount {
 public:
  /// n_start: index at the start. The ray starts along `direction`.
  CausticCount(double n_start, const Vec3& direction)
      : n_start_(n_start), start_(frame_across(direction)), here_(start_) {}

  void pass(const RayState& ray, const RayTangent& tangent);
  int count() const { return count_; }
  /// Returns the largest singular value of the transverse map along the ray so far.
  double widest() const { return widest_; }

 private:
  double n_start_;
  Frame start_, here_;
  // Near the start of the ray, the transverse map is the distance times the identity
  Mat2 before_ = Mat2::Identity();
  int count_ = 0;
  double widest_ = 0;
};

}  // namespace flatspeckle::grin
