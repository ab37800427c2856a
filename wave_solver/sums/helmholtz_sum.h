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

/// Points by strips of equal x, and by z within a strip: what lies within a distance of a place is
/// then one stretch of every strip.
class StripOrder {
 public:
  StripOrder(std::span<const Vec2> points, double height);

  /// Numbers of the points in order.
  std::span<const std::uint32_t> order() const { return order_; }
  struct Stretch {
    std::uint32_t first, count;  // of the ordered points
  };
  /// Stretches that hold all ordered points within `distance` of `place`, and few others.
  void around(Vec2 place, double distance, std::vector<Stretch>& stretches) const;

 private:
  double low_ = 0, height_;
  std::vector<std::uint32_t> order_;
  std::vector<std::size_t> first_;
  std::vector<double> z_;
};

/// u_i = sum_j K(|x_i - y_j|) q_j over pairs closer than the range of a KernelSplit with K = i
/// near, and - far(0) for pairs at distance 0, whose H_0 is left out. The values of K are kept: 8
/// bytes for each of about 1.3 times the pairs.
class NearSum {
 public:
  /// targets: in an order in which neighbours stand close to each other.
  NearSum(const KernelSplit& split, const StripOrder& strips, std::span<const Vec2> sources,
          std::span<const Vec2> targets);

  /// Adds to sums, [column][target], the sums over charges, [column][source in order].
  void add(std::span<const Complex> charges, std::span<Complex> sums) const;

 private:
  struct Block {
    Block(std::size_t begin, std::size_t size) : first(begin), count(size) {}
    std::size_t first, count;              // of the targets
    std::vector<std::uint32_t> stretches;  // of each target
    std::vector<StripOrder::Stretch> sources;
    std::vector<double> values;
    std::vector<std::pair<std::uint32_t, std::uint32_t>> coincident;  // target, source in order
  };
  void fill(Block& block, const KernelSplit& split, const StripOrder& strips,
            std::span<const Vec2> sources, std::span<const Vec2> targets) const;

  std::size_t sources_, targets_;
  std::vector<Block> blocks_;
};

/// About the number of pairs of a source and a target within `range` of each other.
double near_pairs(std::span<const Vec2> sources, std::span<const Vec2> targets, double range);

/// What choices are made by: seconds on one core of a 2.5 GHz machine for the making and for `uses`
/// products of one column. Infinite where memory would pass `most_bytes`. Only ratios matter.
namespace cost {
inline constexpr double uses = 10, most_bytes = 1.5e9;
double grid(const GridShape& shape, double points);
double stored(double bytes, double seconds_to_make);
double all_pairs(double pairs);
}  // namespace cost

/// u_i = sum_j H_0(k |x_i - y_j|) q_j over all pairs of a target x_i and a source y_j that do not
/// coincide. The error is below `tolerance` of ||u||, from 1e-12 on, for charges without special
/// structure. H_0 is split (kernel_split.h) into a near part, summed directly, and a far one,
/// summed on a grid by FFT; where that would cost more than all pairs, they are summed as they are.
class HelmholtzSum {
 public:
  /// Sources and targets are the same points.
  HelmholtzSum(double k, std::span<const Vec2> points, double tolerance)
      : HelmholtzSum(k, points, points, tolerance) {}
  HelmholtzSum(double k, std::span<const Vec2> sources, std::span<const Vec2> targets,
               double tolerance);

  /// charges: [column][source]; returns [column][target]. Threaded unless called from a parallel
  /// region; the result does not depend on the number of threads.
  std::vector<Complex> operator()(std::span<const Complex> charges) const;

  /// Radius within which pairs are summed directly; 0 where all are.
  double range() const { return range_; }

 private:
  std::vector<Complex> all_pairs(std::span<const Complex> charges) const;

  double k_, range_ = 0;
  std::vector<Vec2> sources_, targets_;  // in the order in which they are summed
  std::vector<std::uint32_t> source_order_, target_order_;
  std::optional<NearSum> near_;
  std::optional<GridSum> far_;
};

}  // namespace flatspeckle::wave
