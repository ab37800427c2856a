#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <vector>

#include "grin/index/field_kind.h"
#include "grin/index/radial_field.h"

namespace flatspeckle::grin {

/// n - 1 = (1 - q) s(q), q = r^2/R^2: s a cubic spline of equal cells from q = 0 to 1, which goes
/// on for one cell beyond.
class RadialSplineProfile {
 public:
  /// coefficients: three more than cells. Throws InputError for fewer than 4.
  RadialSplineProfile(double radius, std::vector<double> coefficients);

  double radius() const { return radius_; }
  const std::vector<double>& coefficients() const { return coefficients_; }

  double excess(double u) const {
    const Four at = four(u);
    return (1 - at.q) * sum(at, at.w);
  }
  RadialJet jet(double u) const {
    const Four at = four(u);
    const double s = sum(at, at.w), ds = sum(at, at.d), dds = sum(at, at.dd),
                 area = radius_ * radius_;
    return {(1 - at.q) * s, ((1 - at.q) * ds - s) / area,
            ((1 - at.q) * dds - 2 * ds) / (area * area)};
  }
  /// Adds the derivatives of a excess + b d(excess)/du by the coefficients.
  void add_derivative(double u, double a, double b, double* row) const {
    const Four at = four(u);
    const double area = radius_ * radius_;
    const double value = a * (1 - at.q) - b / area, slope = b * (1 - at.q) / area;
    for (std::size_t i = 0; i < 4; ++i) row[at.cell + i] += value * at.w[i] + slope * at.d[i];
  }

 private:
  /// The four splines that are there: the first, their values and derivatives by q.
  struct Four {
    double q;
    std::size_t cell;
    std::array<double, 4> w, d, dd;
  };
  Four four(double u) const {
    const double cells = static_cast<double>(coefficients_.size() - 3);
    const double q = u / (radius_ * radius_), held = std::clamp(q * cells, 0.0, cells + 1);
    const double cell = held > 0 ? std::min(std::floor(held), cells - 1) : 0;  // 0 also for NaN
    const double t = held - cell, s = 1 - t, c = cells, cc = c * c;
    return {
        q,
        static_cast<std::size_t>(cell),
        {s * s * s / 6, 2 / 3. - t * t * (2 - t) / 2, 2 / 3. - s * s * (2 - s) / 2, t * t * t / 6},
        {-c * s * s / 2, c * t * (3 * t - 4) / 2, -c * s * (3 * s - 4) / 2, c * t * t / 2},
        {cc * s, cc * (3 * t - 2), cc * (3 * s - 2), cc * t}};
  }
  double sum(const Four& at, const std::array<double, 4>& weights) const {
    double sum = 0;
    for (std::size_t i = 0; i < 4; ++i) sum += weights[i] * coefficients_[at.cell + i];
    return sum;
  }

  double radius_;
  std::vector<double> coefficients_;
};

using RadialSpline = RadialField<RadialSplineProfile, 3>;

FieldFacts facts(const RadialSpline& field);

struct RadialSplineValues {
  using Field = RadialSpline;
  static constexpr const char* word = "radial";
  static constexpr bool is_medium = true;
  std::string radial{};
};

void add_keys(Keys& keys, RadialSplineValues& values);
/// Throws InputError naming the file.
RadialSpline make_field(const Keys& keys, const RadialSplineValues& values, const FieldUse& use);

}  // namespace flatspeckle::grin
