#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "core/numbers/complex.h"
#include "core/numbers/random.h"
#include "flatland/media/domain.h"
#include "wave_solver/equations/wave_equations.h"

namespace flatspeckle::wave {

/// What is sorted into boxes: a disk, or a point of radius 0, that carries some unknowns.
struct SortedDisk {
  Vec2 centre;
  double radius = 0;
  std::size_t unknowns = 1;
};

/// Boxes over disks, each halved across its longer side until few unknowns are left in it. A box is
/// shrunk to the centres that it holds before it is halved, so that clusters cost no levels. Two
/// halves at a time, not the four of a quadtree: eliminating twice at half the way costs about half
/// of eliminating once, and less memory.
class BoxTree {
 public:
  struct Box {
    Rectangle hull;                   ///< of its disks, rims included
    std::size_t first = 0, last = 0;  ///< its disks are order()[first .. last - 1]
    std::size_t child = 0;            ///< the first of its two; 0 for a leaf
    std::size_t level = 0;            ///< 0 is the root

    bool is_leaf() const { return child == 0; }
  };

  /// leaf_unknowns: what a leaf may hold; disks of one common centre stay together.
  BoxTree(std::span<const SortedDisk> disks, std::size_t leaf_unknowns);

  /// Level by level from the root, the halves of a box side by side; empty without disks.
  const std::vector<Box>& boxes() const { return boxes_; }
  std::size_t levels() const { return level_.size() - 1; }
  std::size_t level_begin(std::size_t level) const { return level_[level]; }
  std::size_t level_end(std::size_t level) const { return level_[level + 1]; }
  /// Disks so that those of each box stand side by side.
  const std::vector<std::size_t>& order() const { return order_; }

 private:
  void split(std::size_t box, std::span<const SortedDisk> disks, std::size_t leaf_unknowns);
  void add(std::size_t first, std::size_t last, std::size_t level,
           std::span<const SortedDisk> disks);

  std::vector<Box> boxes_;
  std::vector<std::size_t> level_, order_;
};

/// Columns of a real matrix A told by a few of them: A(:, redundant) ~ A(:, skeleton) T.
struct Interpolation {
  std::vector<std::size_t> skeleton, redundant;  ///< ascending
  std::vector<double> t;  ///< T, row by row: t[redundant + |redundant| * skeleton]
};

/// Random combinations of the rows of a real matrix, called samples, in which its columns can be
/// compared: every row is added with random signs to `spread` of them. The mean square of a column
/// over the samples is, in expectation, its squared norm. There are more samples than columns,
/// so that any rank can be found.
class RowSketch {
 public:
  RowSketch(std::size_t columns, RandomStream random);

  void add(std::span<const double> row);
  /// Real and imaginary part become a row each.
  void add(std::span<const Complex> row);

 private:
  friend Interpolation interpolate(RowSketch sketch, double tolerance);
  static constexpr std::size_t spread = 8;

  std::size_t columns_, samples_;
  RandomStream random_;
  std::vector<double> sums_, part_;  // sums_: [sample][column]
};

/// Interpolative decomposition by LU with partial pivoting of the transposed sketch (randomised
/// LUPP of Dong and Martinsson 2021, arXiv:2104.05877), a panel of samples at a time. What earlier
/// panels left of the next samples is a fresh random estimate of the error of every column: it ends
/// where that is below tolerance, in the root mean square over at least 64 of them, for all
/// columns. Costs 6 to 10 per cent more rank than QR with column pivoting and a third of its
/// time.
Interpolation interpolate(RowSketch sketch, double tolerance);

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
