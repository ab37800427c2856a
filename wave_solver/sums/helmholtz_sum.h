#pragma once

#include <optional>
#include <span>
#include <vector>

#include "core/numbers/complex.h"
#include "flatland/media/domain.h"
#include "wave_solver/sums/grid_sum.h"
#include "wave_solver/sums/near_sum.h"

namespace flatspeckle::wave {

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
  HelmholtzSum(double k, std::span<const Vec2> points, double tolerance);
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
