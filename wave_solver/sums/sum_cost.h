#pragma once

#include <span>

#include "flatland/media/domain.h"
#include "wave_solver/sums/grid_sum.h"

namespace flatspeckle::wave {

/// Smallest rectangle that holds all points; at least one of the spans has some.
Extent bounds(std::span<const Vec2> sources, std::span<const Vec2> targets);

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

}  // namespace flatspeckle::wave
