#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/numbers/complex.h"
#include "flatland/media/domain.h"
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

}  // namespace flatspeckle::wave
