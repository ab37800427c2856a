#pragma once

#include <algorithm>
#include <cstddef>
#include <span>
#include <utility>
#include <vector>

#include "core/numbers/complex.h"
#include "wave_solver/equations/wave_equations.h"
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

/// Direct solver of the multiple-scattering equations for large placements: recursive
/// skeletonization of the complex symmetric M on a tree of boxes (Martinsson and Rokhlin 2005; Ho
/// and Greengard 2012). Some unknowns of a box, about as many as its perimeter has half
/// wavelengths, and more with log(1/tolerance), can tell all waves that leave it. The others are
/// eliminated, and boxes are joined two by two until one is left.
///
/// Cost about N^(3/2), memory about N log N at fixed density, whether the scattering resonates or
/// not. Error: M is replaced by a matrix that differs by about `tolerance` in norm; the relative
/// residual of a solution is about that, its relative error larger by the condition of M.
/// Elimination is without pivoting: residuals of many resonant scatterers stop falling before the
/// tolerance does (16384 points: 5e-11 at 1e-10, 2e-9 at 1e-12). A step of refinement mends that.
class FastDirect {
 public:
  struct Level {
    std::size_t boxes = 0;     ///< that were compressed at this level
    std::size_t unknowns = 0;  ///< that they held, in sum
    std::size_t skeleton = 0;  ///< that are left of them, in sum
    std::size_t largest = 0;   ///< skeleton of one box
  };
  struct Statistics {
    double cpu_seconds = 0, wall_seconds = 0;  ///< of the factorization
    double bytes = 0;                          ///< that the factors occupy
    std::vector<Level> levels;                 ///< from the leaves upwards
    std::size_t root = 0;                      ///< unknowns of the last, dense factor
  };

  /// Factors M. Threaded over the boxes of a level, with the same result for any number of
  /// threads. Throws InputError where more than `memory` bytes might be needed, before a level is
  /// begun, and std::runtime_error for singular equations. 0 < tolerance < 1.
  FastDirect(const WaveEquations& system, double tolerance, double memory = memory_of_system());

  /// X <- M^-1 X, threaded likewise; x: [column][unknown].
  void solve(std::span<Complex> x) const;

  const Statistics& statistics() const { return statistics_; }

 private:
  class Builder;
  void solve_root(std::vector<Complex>& x, std::size_t columns) const;

  std::size_t unknowns_;
  std::vector<std::vector<SkeletonElimination>> levels_;  // from the leaves upwards
  std::vector<std::size_t> root_unknowns_;
  std::vector<Complex> root_;  // its lower triangular factor
  Statistics statistics_;
};

}  // namespace flatspeckle::wave
