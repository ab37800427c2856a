#pragma once

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <vector>

#include "grin/media/fields/profile_spline.h"
#include "grin/media/index/guide.h"
#include "grin/media/index/radial_field.h"

namespace flatspeckle::grin {

/// The graded index of a fibre of core radius R at the distance rho from its axis: n^2 = n0^2 (1 -
/// 2 Delta p(q)) with q = rho^2/R^2 and p = q^(g/2) + q (1 - q) s(q). The first term of p is a
/// power law of exponent g [gloge1973]. The second term is a correction by a spline s; it vanishes
/// on the axis and at rho = R. Functions take u = rho^2 as their argument.
class GradedProfile {
 public:
  struct Core {
    double axis_excess, delta, radius, exponent = 2;
  };
  /// correction: coefficients of the spline s; empty for a pure power law.
  explicit GradedProfile(const Core& core, std::vector<double> correction = {});

  const Core& core() const { return core_; }
  bool is_corrected() const { return is_corrected_; }
  /// Returns the coefficients of the spline s; zeros if there is no correction.
  const std::vector<double>& correction() const { return correction_.coefficients(); }

  double excess(double u) const { return excess_of(shape(u).value); }
  RadialJet jet(double u) const {
    const Shape p = shape(u);
    const double n = 1 + excess_of(p.value), scale = square_scale() / (2 * n);
    const double first = scale * p.derivative;  // n n' = (n^2)'/2
    return {n - 1, first, scale * p.second_derivative - first * first / n};
  }
  /// Adds to `row` the derivatives of a (n - 1) + b dn/du with respect to the coefficients of the
  /// correction s.
  void add_by_correction(double u, double a, double b, double* row) const {
    const double q = u / area();
    add_by_shape(u, a, b, [&](double value, double derivative) {
      const double hump = q * (1 - q);
      ProfileSpline::add(correction_.four(q), value * hump + derivative * (1 - 2 * q) / area(),
                         derivative * hump / area(), row);
    });
  }
  /// Adds to *exponent the derivative of a (n - 1) + b dn/du with respect to the exponent g.
  void add_by_exponent(double u, double a, double b, double* exponent) const {
    const double q = held(u / area()), power = std::pow(q, core_.exponent / 2), log = std::log(q);
    add_by_shape(u, a, b, [&](double value, double derivative) {
      *exponent += value * power * log / 2 +
                   derivative * power * (core_.exponent * log / 2 + 1) / (2 * q * area());
    });
  }

 private:
  /// Value of the profile p, and its derivatives with respect to u.
  struct Shape {
    double value, derivative, second_derivative;
  };
  static double held(double q) { return std::max(q, 1e-30); }
  double area() const { return core_.radius * core_.radius; }
  double square_scale() const {
    const double n0 = 1 + core_.axis_excess;
    return -2 * core_.delta * n0 * n0;
  }
  double excess_of(double p) const {
    // n - 1 is computed from n0 - 1, so that it keeps all digits even if it is small
    const double e = core_.axis_excess;
    const double square = e * (2 + e) + square_scale() * p;
    return square / (1 + std::sqrt(1 + square));
  }
  Shape power_law(double q) const {
    if (core_.exponent == 2) return {q, 1, 0};
    const double h = core_.exponent / 2, safe = held(q), power = std::pow(safe, h);
    return {power, h * power / safe, h * (h - 1) * power / (safe * safe)};
  }
  Shape shape(double u) const {
    const double q = u / area();
    Shape p = power_law(q);
    if (is_corrected_) {
      const ProfileSpline::Four four = correction_.four(q);
      const double s = correction_.sum(four, four.w), d = correction_.sum(four, four.d),
                   dd = correction_.sum(four, four.dd), hump = q * (1 - q);
      p.value += hump * s;
      p.derivative += (1 - 2 * q) * s + hump * d;
      p.second_derivative += -2 * s + 2 * (1 - 2 * q) * d + hump * dd;
    }
    return {p.value, p.derivative / area(), p.second_derivative / (area() * area())};
  }
  /// Calls use(A, B), where A and B are the derivatives of a (n - 1) + b dn/du with respect to p
  /// and dp/du.
  template <class Use>
  void add_by_shape(double u, double a, double b, const Use& use) const {
    const Shape p = shape(u);
    const double n = 1 + excess_of(p.value), scale = square_scale() / (2 * n);
    use(a * scale - b * scale * scale * p.derivative / n, b * scale);
  }

  Core core_;
  bool is_corrected_;
  ProfileSpline correction_;
};

using GradedGuide = RadialField<GradedProfile, 2>;

FieldFacts facts(const GradedGuide& field);

struct GradedValues {
  using Field = GradedGuide;
  static constexpr const char* word = "graded";
  static constexpr bool is_medium = true;
  double index = 1, exponent = 2;
  std::optional<double> delta = {}, core_radius = {};
  std::string graded{};
  std::vector<double> centre{0, 0, 0};
};

void add_keys(Keys& keys, GradedValues& values);
/// Makes the field from its scene keys. Throws InputError for invalid values.
GradedGuide make_field(const Keys& keys, const GradedValues& values, const FieldUse& use);

}  // namespace flatspeckle::grin
