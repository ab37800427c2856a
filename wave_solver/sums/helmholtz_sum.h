#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "core/numbers/complex.h"
#include "flatland/media/domain.h"
#include "wave_solver/sums/grid_sum.h"
#include "wave_solver/sums/kernel_split.h"

namespace flatspeckle::wave {

/// Points sorted into strips of equal height along x, in space also along y, and by z within a
/// strip. The points within a given distance of a position are then contained in one interval of
/// each strip.
class StripOrder {
 public:
  StripOrder(std::span<const Vec> points, double height);

  /// Indices of the points, in the sorted order.
  std::span<const std::uint32_t> order() const { return order_; }
  struct Interval {
    std::uint32_t first, count;  // order()[first .. first + count - 1]
  };
  /// Appends intervals that contain all points within `distance` of `place`, and few other points.
  void around(Vec place, double distance, std::vector<Interval>& intervals) const;

 private:
  Vec low_;
  double height_;
  std::size_t levels_ = 1;  // number of strips along y
  std::vector<std::uint32_t> order_;
  std::vector<std::size_t> first_;
  std::vector<double> z_;
};

/// Computes the near part of a HelmholtzSum: u_i = sum_j K(|x_i - y_j|) q_j over pairs of a target
/// x_i and a source y_j closer than the range of a KernelSplit. K = i near, and K = -far(0) for
/// pairs at distance 0, whose H_0 is omitted. About 1.3 values of K per pair are stored (1.7 in
/// space), with 8 bytes each.
class NearSum {
 public:
  /// targets: in an order in which points close in space are close in the list.
  NearSum(const KernelSplit& split, const StripOrder& strips, std::span<const Vec> sources,
          std::span<const Vec> targets);

  /// Computes the sums for several columns of charges, [column][source in the order of the strips],
  /// and adds them to `sums`, [column][target].
  void add(std::span<const Complex> charges, std::span<Complex> sums) const;

 private:
  struct Block {
    Block(std::size_t begin, std::size_t size) : first(begin), count(size) {}
    std::size_t first, count;                    // targets first .. first + count - 1
    std::vector<std::uint32_t> interval_counts;  // number of intervals of each target
    std::vector<StripOrder::Interval> sources;
    std::vector<double> values;
    std::vector<std::pair<std::uint32_t, std::uint32_t>> coincident;  // target, source in order
  };
  void fill(Block& block, const KernelSplit& split, const StripOrder& strips,
            std::span<const Vec> sources, std::span<const Vec> targets) const;

  std::size_t sources_, targets_;
  std::vector<Block> blocks_;
};

/// Estimates the number of pairs of a source and a target within `range` of each other.
double near_pairs(std::span<const Vec> sources, std::span<const Vec> targets, double range,
                  Radial kind = Radial::cylindrical);

/// Cost model for the choice of an algorithm: seconds on one core of a 2.5 GHz machine for the
/// setup and `uses` products with one column, by a GridSum (grid), with stored values (stored), or
/// by direct summation (all_pairs). The cost is infinite if memory would exceed `most_bytes` or
/// memory_of_system(). Only ratios matter.
namespace cost {
inline constexpr double uses = 10, most_bytes = 1.5e9;
double grid(const GridShape& shape, double points);
double stored(double bytes, double seconds_to_make);
double all_pairs(double pairs, Radial kind);
}  // namespace cost

/// Computes u_i = sum_j H_0(k |x_i - y_j|) q_j over all pairs of a target x_i and a source y_j that
/// do not coincide, or the same with h_0 in space (Radial::spherical). The error is below
/// `tolerance` times ||u|| for charges without special structure and tolerances from 1e-12 on. H_0
/// is split (kernel_split.h) into a near part, summed directly, and a far part, summed on a grid by
/// FFT. If it is cheaper, H_0 is summed directly over all pairs.
class HelmholtzSum {
 public:
  /// Uses the same points as sources and as targets.
  HelmholtzSum(double k, std::span<const Vec> points, double tolerance,
               Radial kind = Radial::cylindrical)
      : HelmholtzSum(k, points, points, tolerance, kind) {}
  HelmholtzSum(double k, std::span<const Vec> sources, std::span<const Vec> targets,
               double tolerance, Radial kind = Radial::cylindrical);
  /// Uses this range instead of the cheapest; 0 to sum all pairs directly.
  HelmholtzSum(double k, std::span<const Vec> points, double tolerance, Radial kind, double range);

  /// charges: [column][source]; returns [column][target]. Threaded unless called from a parallel
  /// region; the result does not depend on the number of threads.
  std::vector<Complex> operator()(std::span<const Complex> charges) const;

  /// Distance within which pairs are summed directly; 0 if all pairs are summed directly.
  double range() const { return range_; }

 private:
  void split_sums(double tolerance);
  std::vector<Complex> all_pairs(std::span<const Complex> charges) const;

  double k_, range_ = 0;
  Radial kind_;
  std::vector<Vec> sources_, targets_;  // in the order in which they are summed
  std::vector<std::uint32_t> source_order_, target_order_;
  std::optional<NearSum> near_;
  std::optional<GridSum> far_;
};

}  // namespace flatspeckle::wave
