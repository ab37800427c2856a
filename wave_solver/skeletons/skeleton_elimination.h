#pragma once

#include <algorithm>
#include <cstddef>
#include <utility>
#include <vector>

#include "core/numbers/complex.h"
#include "wave_solver/skeletons/interpolative.h"

namespace flatspeckle::wave {

/// Elimination of those unknowns R of a box whose waves outside are told by its skeleton S. In the
/// variables y_R = x_R, y_S = x_S + T x_R, a real congruence, the redundant ones do not reach
/// beyond the box:
///   X_RR = M_RR - M_RS T - T^T M_SR + T^T M_SS T = L L^T,   Q = M_SR - M_SS T,   E = Q L^-T,
/// and what is left of the box is M_SS - E E^T (Ho and Greengard 2012).
class SkeletonElimination {
 public:
  SkeletonElimination() = default;
  /// unknowns: those of the box; m: the box's block of M, |unknowns| squared, symmetric. Throws
  /// std::runtime_error where X_RR is singular.
  SkeletonElimination(const std::vector<std::size_t>& unknowns, const std::vector<Complex>& m,
                      const Interpolation& interpolation);

  const std::vector<std::size_t>& skeleton() const { return skeleton_; }
  /// Memory that the factors occupy.
  double bytes() const;
  /// M_SS - E E^T, full; to be taken once.
  std::vector<Complex> take_rest() { return std::move(rest_); }

  /// The two halves of a solution, in place; x: [unknown][column], all unknowns of M.
  void forward(Complex* x, std::size_t columns) const;
  void backward(Complex* x, std::size_t columns) const;

 private:
  void congruence();

  std::vector<std::size_t> skeleton_, redundant_;
  std::vector<double> t_;              // T^T, column-major
  std::vector<Complex> e_, l_, rest_;  // column-major
};

}  // namespace flatspeckle::wave
