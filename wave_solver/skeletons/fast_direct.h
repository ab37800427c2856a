#pragma once

#include <algorithm>
#include <cstddef>
#include <functional>
#include <span>
#include <utility>
#include <vector>

#include "core/numbers/complex.h"
#include "wave_solver/equations/wave_equations.h"
#include "wave_solver/skeletons/interpolative.h"

namespace flatspeckle::wave {

/// Elimination of the redundant unknowns R of a box, whose waves outside the box are interpolated,
/// by the matrix T of an Interpolation, from those of its skeleton S. In the variables y_R = x_R,
/// y_S = x_S + T x_R (a real congruence), the redundant unknowns do not couple to unknowns outside
/// the box. With
///   X_RR = M_RR - M_RS T - T^T M_SR + T^T M_SS T = L L^T,   Q = M_SR - M_SS T,   E = Q L^-T,
/// the Schur complement of the box is M_SS - E E^T [ho2012].
class SkeletonElimination {
 public:
  SkeletonElimination() = default;
  /// unknowns: the unknowns of the box. m: the symmetric block of M for these unknowns. Throws
  /// std::runtime_error if X_RR is singular.
  SkeletonElimination(const std::vector<std::size_t>& unknowns, const std::vector<Complex>& m,
                      const Interpolation& interpolation);

  const std::vector<std::size_t>& skeleton() const { return skeleton_; }
  /// Memory of the factors, in bytes.
  double bytes() const;
  /// Moves M_SS - E E^T (both triangles) out of this object; to be called once.
  std::vector<Complex> take_schur_complement() { return std::move(schur_complement_); }
  /// Frees all but the skeleton. forward() and backward() are then undefined.
  void forget();

  /// Forward and backward substitution, in place, for the unknowns of this box. x: columns over all
  /// unknowns of M, [unknown][column].
  void forward(Complex* x, std::size_t columns) const;
  void backward(Complex* x, std::size_t columns) const;

 private:
  void congruence();

  std::vector<std::size_t> skeleton_, redundant_;
  std::vector<double> t_;                          // T^T, column-major
  std::vector<Complex> e_, l_, schur_complement_;  // column-major
};

/// Direct solver of the multiple-scattering equations for large placements: recursive
/// skeletonization of the complex symmetric M on a tree of boxes (Martinsson and Rokhlin
/// [martinsson2005]; Ho and Greengard [ho2012]). A subset of the unknowns of a box (the skeleton)
/// determines all waves that leave the box. The size of the skeleton is about the number of half
/// wavelengths along the perimeter, and grows with log(1/tolerance). The other unknowns are
/// eliminated, and boxes are merged in pairs until one box is left.
///
/// For N unknowns at fixed density, the cost grows about as N^(3/2) and the memory as N log N, with
/// or without resonances. The solver replaces M by a matrix that differs from it by about
/// `tolerance` in norm. The relative residual of a solution is about the same; its relative error
/// is larger by the condition number of M. Elimination does not pivot. With many resonant
/// scatterers the residual therefore does not decrease as far as the tolerance (16384 points:
/// residual 5e-11 at tolerance 1e-10, but 2e-9 at 1e-12). One step of iterative refinement corrects
/// this.
class FastDirect {
 public:
  struct Level {
    std::size_t boxes = 0;     ///< number of boxes compressed at this level
    std::size_t unknowns = 0;  ///< unknowns of these boxes before compression
    std::size_t skeleton = 0;  ///< unknowns of these boxes after compression
    std::size_t largest = 0;   ///< largest skeleton of a box
  };
  struct Statistics {
    double cpu_seconds = 0, wall_seconds = 0;  ///< time of the factorization
    double bytes = 0;                          ///< memory of the factors
    std::vector<Level> levels;                 ///< sizes of each level, from the leaves upwards
    std::size_t root = 0;                      ///< unknowns of the last, dense factorization
  };

  /// Adds coupling between distant bodies to the Schur complement of all unknowns but the listed
  /// ones, a column-major matrix, which need not stay symmetric.
  using RootCoupling =
      std::function<void(std::span<const std::size_t> unknowns, std::vector<Complex>& matrix)>;
  struct Options {
    double memory = memory_of_system();
    /// Number of copies of the first bodies that follow them in the system, each displaced as a
    /// whole. Only the first bodies are solved for. Skeletons also represent their waves at the
    /// copies, and waves from the copies, so that the coupling to them can be added at the root.
    std::size_t copies = 0;
    RootCoupling coupling = nullptr;
    bool solves = true;  ///< keeps the factors of boxes, which solve() requires
  };

  /// Factors M. Threaded over the boxes of a level; the result does not depend on the number of
  /// threads. Throws InputError before a level that might need more memory than available, and
  /// std::runtime_error for singular equations. Precondition: 0 < tolerance < 1.
  FastDirect(const WaveEquations& system, double tolerance, const Options& options);
  FastDirect(const WaveEquations& system, double tolerance)
      : FastDirect(system, tolerance, Options()) {}

  /// Replaces x, [column][unknown], by M^-1 x. Threaded over the boxes of a level.
  void solve(std::span<Complex> x) const;

  /// The last unknowns, which represent all others in waves to and from the outside of the system:
  /// if b and c are coefficients of waves from outside, such as right-hand sides of plane waves,
  /// then c^T M^-1 b is the same sum over these unknowns alone, with solve_root() instead of M^-1.
  std::span<const std::size_t> root_unknowns() const { return root_unknowns_; }
  /// Replaces columns over root_unknowns().
  void solve_root(std::span<Complex> x) const;

  const Statistics& statistics() const { return statistics_; }

 private:
  class Builder;
  void factor_root(const RootCoupling& coupling);
  void solve_root_of(std::vector<Complex>& x, std::size_t columns) const;

  std::size_t unknowns_;
  bool solves_;
  std::vector<std::vector<SkeletonElimination>> levels_;  // boxes by level, from the leaves upwards
  std::vector<std::size_t> root_unknowns_;
  std::vector<Complex> root_;  // lower triangular factor for root_unknowns_, or LU with pivots_
  std::vector<int> pivots_;
  Statistics statistics_;
};

}  // namespace flatspeckle::wave
