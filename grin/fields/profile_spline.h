#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "core/error.h"

namespace flatspeckle::grin {

/// A cubic spline of equal cells from t = 0 to 1, of which it goes on for one beyond.
class ProfileSpline {
 public:
  /// coefficients: three more than cells. Throws InputError for fewer than 4, or one that is not
  /// finite.
  explicit ProfileSpline(std::vector<double> coefficients);

  const std::vector<double>& coefficients() const { return coefficients_; }

  /// The four splines that are there: the first, their values and derivatives by t.
  struct Four {
    std::size_t cell;
    std::array<double, 4> w, d, dd;
  };
  Four four(double t) const {
    const double cells = static_cast<double>(coefficients_.size() - 3);
    const double held = std::clamp(t * cells, 0.0, cells + 1);
    const double cell = held > 0 ? std::min(std::floor(held), cells - 1) : 0;  // 0 also for NaN
    const double u = held - cell, s = 1 - u, c = cells, cc = c * c;
    return {
        static_cast<std::size_t>(cell),
        {s * s * s / 6, 2 / 3. - u * u * (2 - u) / 2, 2 / 3. - s * s * (2 - s) / 2, u * u * u / 6},
        {-c * s * s / 2, c * u * (3 * u - 4) / 2, -c * s * (3 * s - 4) / 2, c * u * u / 2},
        {cc * s, cc * (3 * u - 2), cc * (3 * s - 2), cc * u}};
  }
  double sum(const Four& at, const std::array<double, 4>& weights) const {
    double sum = 0;
    for (std::size_t i = 0; i < 4; ++i) sum += weights[i] * coefficients_[at.cell + i];
    return sum;
  }
  /// Adds value times the splines and slope times their derivatives to a row of coefficients.
  static void add(const Four& at, double value, double slope, double* row) {
    for (std::size_t i = 0; i < 4; ++i) row[at.cell + i] += value * at.w[i] + slope * at.d[i];
  }

 private:
  std::vector<double> coefficients_;
};

}  // namespace flatspeckle::grin
