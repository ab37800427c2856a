#pragma once

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "grin/media/fields/profile_spline.h"
#include "grin/media/index/field_kind.h"
#include "grin/media/index/radial_field.h"

namespace flatspeckle::grin {

/// n - 1 = (1 - q) s, q = r^2/R^2: s a cubic spline of equal cells in t, q = t (5 - t)/4, which are
/// narrower towards the rim, where a lens bends most; it goes on for one cell beyond.
class RadialSplineProfile {
 public:
  /// coefficients: three more than cells. Throws InputError for fewer than 4 or one that is not
  /// finite and above -1.
  RadialSplineProfile(double radius, std::vector<double> coefficients);

  double radius() const { return radius_; }
  const std::vector<double>& coefficients() const { return spline_.coefficients(); }

  double excess(double u) const {
    const Place at = place(u);
    const ProfileSpline::Four four = spline_.four(at.t);
    return (1 - at.q) * spline_.sum(four, four.w);
  }
  RadialJet jet(double u) const {
    const Place at = place(u);
    const ProfileSpline::Four four = spline_.four(at.t);
    const double s = spline_.sum(four, four.w), by_t = spline_.sum(four, four.d);
    const double ds = by_t * at.slope,
                 dds = spline_.sum(four, four.dd) * at.slope * at.slope + by_t * at.bend;
    const double area = radius_ * radius_;
    return {(1 - at.q) * s, ((1 - at.q) * ds - s) / area,
            ((1 - at.q) * dds - 2 * ds) / (area * area)};
  }
  /// Adds the derivatives of a excess + b d(excess)/du by the coefficients.
  void add_derivative(double u, double a, double b, double* row) const {
    const Place at = place(u);
    const double area = radius_ * radius_;
    ProfileSpline::add(spline_.four(at.t), a * (1 - at.q) - b / area,
                       b * (1 - at.q) * at.slope / area, row);
  }

 private:
  /// t and its derivatives by q.
  struct Place {
    double q, t, slope, bend;
  };
  Place place(double u) const {
    const double q = u / (radius_ * radius_), root = std::sqrt(std::max(25 - 16 * q, 1.0));
    return {q, (5 - root) / 2, 4 / root, 32 / (root * root * root)};
  }

  double radius_;
  ProfileSpline spline_;
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
