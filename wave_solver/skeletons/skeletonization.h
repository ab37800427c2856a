#pragma once

#include <span>
#include <vector>

#include "wave_solver/equations/wave_equations.h"
#include "wave_solver/skeletons/box_tree.h"
#include "wave_solver/skeletons/interpolative.h"

namespace flatspeckle::wave {

/// Unknowns of a box, as they stand before some of them are eliminated.
struct ActiveBox {
  Rectangle hull;                         ///< of the disks that they belong to
  std::span<const std::size_t> unknowns;  ///< those of one scatterer side by side
};

/// Points on the closed curve at a distance outside of a rectangle, evenly spaced by at most
/// `spacing`: four straight sides and four quarters of a circle.
std::vector<Vec2> proxy_contour(const Rectangle& hull, double distance, double spacing);

/// Which unknowns of a box can tell the waves of all others outside of it, to a tolerance. Rows to
/// compare them by are
/// - the equations of all unknowns within a distance of the box, one by one, and
/// - for what lies beyond, the field on the contour at that distance: outgoing waves that are small
///   there are small outside (Martinsson and Rokhlin 2005).
/// Waves about a point expand in waves about another with real coefficients, so that real and
/// imaginary parts of the rows share a real T of hardly higher rank.
class Skeletonization {
 public:
  /// tolerance: of the 2-norm of each column of M between the box and all others.
  Skeletonization(const WaveEquations& system, double tolerance);

  /// Within this distance, rim to rim, unknowns are wanted in `near`. It makes near rows about as
  /// many as points on the contour.
  double distance(const ActiveBox& box) const;
  Interpolation operator()(const ActiveBox& box, std::span<const std::size_t> near,
                           RandomStream random) const;

 private:
  void add_near(const ActiveBox& box, std::span<const std::size_t> near, RowSketch& sketch) const;
  void add_contour(const ActiveBox& box, RowSketch& sketch) const;

  const WaveEquations& system_;
  double tolerance_, logarithm_;  // ln(1/tolerance)
  double weight_ = 0;             // of the contour's rows
};

}  // namespace flatspeckle::wave
