#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>
#include <vector>

#include "core/error.h"
#include "grin/media/index/cubic_splines.h"

namespace flatspeckle::grin {

/// A cubic spline of equal cells from t = 0 to 1, of which it goes on for one beyond.
class ProfileSpline {
 public:
  /// coefficients: three more than cells. Throws InputError for fewer than 4, or one that is not
  /// finite.
  explicit ProfileSpline(std::vector<double> coefficients)
      : coefficients_(std::move(coefficients)) {
    if (coefficients_.size() < 4)
      throw InputError("coefficients of a profile", coefficients_.size(), "must be at least 4");
    for (const double c : coefficients_)
      if (!std::isfinite(c)) throw InputError("coefficient of a profile", c, "must be finite");
  }

  const std::vector<double>& coefficients() const { return coefficients_; }

  /// The four splines that are there: the first, their values and derivatives by t.
  struct Four {
    std::size_t cell;
    std::array<double, 4> w, d, dd;
  };
  Four four(double t) const {
    const double cells = static_cast<double>(coefficients_.size() - 3);
    const double held = std::clamp(t * cells, 0.0, cells + 1);
    const double cell = cell_of(held, cells);
    const CubicSplines splines{held - cell};
    return {static_cast<std::size_t>(cell), splines.values(), splines.slopes(cells),
            splines.turns(cells * cells)};
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
