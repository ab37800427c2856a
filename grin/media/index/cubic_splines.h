#pragma once

#include <algorithm>
#include <array>
#include <cmath>

namespace flatspeckle::grin {

/// The four cubic B-splines of equal cells that are there at t of a cell, from 0 to 1; beyond, the
/// cubics that they are in it. Values, and derivatives by t.
struct CubicSplines {
  using Four = std::array<double, 4>;
  double t, s = 1 - t;

  Four values() const {
    return {s * s * s / 6, 2 / 3. - t * t * (2 - t) / 2, 2 / 3. - s * s * (2 - s) / 2,
            t * t * t / 6};
  }
  /// Times a scale, as the next.
  Four slopes(double scale) const {
    return {-scale * s * s / 2, scale * t * (3 * t - 4) / 2, -scale * s * (3 * s - 4) / 2,
            scale * t * t / 2};
  }
  Four turns(double scale) const {
    return {scale * s, scale * (3 * t - 2), scale * (3 * s - 2), scale * t};
  }
};

/// The cell of so many that a place is in, 0 for NaN; beyond the ends the last one.
inline double cell_of(double place, double cells) {
  return place > 0 ? std::min(std::floor(place), cells - 1) : 0;
}

}  // namespace flatspeckle::grin
