#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>
#include <vector>

#include "core/error.h"
#include "grin/media/index/cubic_splines.h"

namespace flatspeckle::grin {

/// A cubic spline with equal cells from t = 0 to 1, continued for one cell beyond t = 1.
class ProfileSpline {
 public:
  /// The number of cells is the number of coefficients minus 3. Throws InputError for fewer than 4
  /// coefficients, or if one is not finite.
  explicit ProfileSpline(std::vector<double> coefficients)
      : coefficients_(std::move(coefficients)) {
    if (coefficients_.size() < 4)
      throw InputError("coefficients of a profile", coefficients_.size(), "must be at least 4");
    for (const double c : coefficients_)
      if (!std::isfinite(c)) throw InputError("coefficient of a profile", c, "must be finite");
  }

  const std::vector<double>& coefficients() const { return coefficients_; }

  /// The four basis splines that are nonzero at t: index of the first, values w, and first and
  /// second derivatives d and dd with respect to t.
  struct Four {
    std::size_t cell;
    std::array<double, 4> w, d, dd;
  };
  Four four(double t) const {
    const double cells = static_cast<double>(coefficients_.size() - 3);
    const double held = std::clamp(t * cells, 0.0, cells + 1);
    const double cell = cell_of(held, cells);
    const CubicSplines splines{held - cell};
    return {static_cast<std::size_t>(cell), splines.values(), splines.derivatives(cells),
            splines.second_derivatives(cells * cells)};
  }
  double sum(const Four& at, const std::array<double, 4>& weights) const {
    double sum = 0;
    for (std::size_t i = 0; i < 4; ++i) sum += weights[i] * coefficients_[at.cell + i];
    return sum;
  }
  /// Adds value * spline + derivative * (derivative of the spline) to `row`, for each of the four
  /// splines that are nonzero at `at`.
  static void add(const Four& at, double value, double derivative, double* row) {
    for (std::size_t i = 0; i < 4; ++i) row[at.cell + i] += value * at.w[i] + derivative * at.d[i];
  }

 private:
  std::vector<double> coefficients_;
};

}  // namespace flatspeckle::grin
