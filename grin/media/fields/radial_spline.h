#pragma once

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "grin/media/fields/profile_spline.h"
#include "grin/media/index/field_kind.h"
#include "grin/media/index/radial_field.h"

namespace flatspeckle::grin {

/// Index profile of a ball of radius R: n = n_host + (1 - q) s with q = r^2/R^2, where r is the
/// distance from the centre. s is a cubic spline with equal cells in t, where q = t (5 - t)/4. In
/// q, the cells are narrower towards the rim, where a lens bends rays most. s continues one cell
/// beyond the rim. Functions take u = r^2 as their argument.
class RadialSplineProfile {
 public:
  /// The number of cells is the number of coefficients minus 3. Throws InputError for fewer than 4
  /// coefficients, or if one is not finite and above -1.
  RadialSplineProfile(double radius, std::vector<double> coefficients, double host_excess = 0);

  double radius() const { return radius_; }
  double host_excess() const { return host_excess_; }  ///< n_host - 1
  const std::vector<double>& coefficients() const { return spline_.coefficients(); }

  double excess(double u) const {
    const Place at = place(u);
    const ProfileSpline::Four four = spline_.four(at.t);
    return host_excess_ + (1 - at.q) * spline_.sum(four, four.w);
  }
  RadialJet jet(double u) const {
    const Place at = place(u);
    const ProfileSpline::Four four = spline_.four(at.t);
    const double s = spline_.sum(four, four.w), by_t = spline_.sum(four, four.d);
    const double ds = by_t * at.derivative,
                 dds = spline_.sum(four, four.dd) * at.derivative * at.derivative +
                       by_t * at.second_derivative;
    const double area = radius_ * radius_;
    return {host_excess_ + (1 - at.q) * s, ((1 - at.q) * ds - s) / area,
            ((1 - at.q) * dds - 2 * ds) / (area * area)};
  }
  /// Adds to `row` the derivatives of a (n - 1) + b dn/du with respect to the coefficients of s.
  void add_derivative(double u, double a, double b, double* row) const {
    const Place at = place(u);
    const double area = radius_ * radius_;
    ProfileSpline::add(spline_.four(at.t), a * (1 - at.q) - b / area,
                       b * (1 - at.q) * at.derivative / area, row);
  }

 private:
  /// A value of q, the argument t of the spline there, and the derivatives of t with respect to q.
  struct Place {
    double q, t, derivative, second_derivative;
  };
  Place place(double u) const {
    const double q = u / (radius_ * radius_), root = std::sqrt(std::max(25 - 16 * q, 1.0));
    return {q, (5 - root) / 2, 4 / root, 32 / (root * root * root)};
  }

  double radius_, host_excess_;
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
/// Reads the field from the file given by its key. Throws an InputError that names the file.
RadialSpline make_field(const Keys& keys, const RadialSplineValues& values, const FieldUse& use);

}  // namespace flatspeckle::grin
