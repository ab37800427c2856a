#pragma once

#include <algorithm>
#include <array>
#include <cmath>

namespace flatspeckle::grin {

/// Values and derivatives of the four cubic B-splines that are nonzero in a cell of a grid with
/// equal cells. t, from 0 to 1, is the position within the cell. For other t, the cubics of the
/// cell are continued.
struct CubicSplines {
  using Four = std::array<double, 4>;
  double t, s = 1 - t;

  Four values() const {
    return {s * s * s / 6, 2 / 3. - t * t * (2 - t) / 2, 2 / 3. - s * s * (2 - s) / 2,
            t * t * t / 6};
  }
  /// Returns scale times the first derivatives with respect to t.
  Four derivatives(double scale) const {
    return {-scale * s * s / 2, scale * t * (3 * t - 4) / 2, -scale * s * (3 * s - 4) / 2,
            scale * t * t / 2};
  }
  /// Returns scale times the second derivatives with respect to t.
  Four second_derivatives(double scale) const {
    return {scale * s, scale * (3 * t - 2), scale * (3 * s - 2), scale * t};
  }
};

/// Returns the index of the cell that contains a position, where `cells` cells of size 1 begin at
/// 0. Positions beyond the ends belong to the first or last cell, and NaN to cell 0.
inline double cell_of(double place, double cells) {
  return place > 0 ? std::min(std::floor(place), cells - 1) : 0;
}

}  // namespace flatspeckle::grin
