#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <optional>

#include <Eigen/Core>

#include "grin/media/geometry/vec3.h"

namespace flatspeckle::grin {

/// A polynomial on [0, 1], given by its Bernstein coefficients. Its values stay within the range of
/// the coefficients, and it has no more zeros than the coefficients have changes of sign.
template <std::size_t size>
struct Bernstein {
  std::array<double, size> c;

  struct Halves {
    Bernstein left, right;
  };
  /// Splits the polynomial at t by de Casteljau's algorithm; its value at t is right.c[0].
  Halves split(double t) const {
    Halves halves{{}, *this};
    for (std::size_t last = size; last-- > 0;) {
      halves.left.c[size - 1 - last] = halves.right.c[0];
      for (std::size_t i = 0; i < last; ++i)
        halves.right.c[i] += t * (halves.right.c[i + 1] - halves.right.c[i]);
    }
    return halves;
  }

  /// Returns the fraction of [0, 1] where the polynomial is negative.
  double negative_share(int halvings = 5) const {
    const bool first = c[0] < 0;
    if (std::ranges::all_of(c, [&](double at) { return (at < 0) == first; })) return first;
    if (halvings == 0) {
      const double part = c[0] / (c[0] - c[size - 1]);
      return first == (c[size - 1] < 0) ? first : first ? part : 1 - part;
    }
    const Halves halves = split(0.5);
    return (halves.left.negative_share(halvings - 1) + halves.right.negative_share(halvings - 1)) /
           2;
  }

  /// Returns the polynomial (p(t) - p(0)) / t, where p is this polynomial.
  Bernstein<size - 1> without_zero_at_start() const {
    constexpr double degree = size - 1;
    Bernstein<size - 1> rest;
    for (std::size_t i = 0; i + 1 < size; ++i)
      rest.c[i] = (c[i + 1] - c[0]) * degree / static_cast<double>(i + 1);
    return rest;
  }

  /// Returns the first point where a polynomial that is positive at 0 changes its sign; values
  /// above -tolerance count as positive. Two zeros closer to each other than 2^-24 may be missed.
  std::optional<double> first_zero(double tolerance, int halvings = 24) const {
    std::size_t changes = 0;
    for (std::size_t i = 1; i < size; ++i)
      changes += (c[i - 1] > -tolerance) != (c[i] > -tolerance);
    if (changes == 0) return std::nullopt;
    if (changes == 1) return only_zero();
    if (halvings == 0) return c[size - 1] > -tolerance ? std::nullopt : std::optional(only_zero());
    const Halves halves = split(0.5);
    if (const auto zero = halves.left.first_zero(tolerance, halvings - 1)) return *zero / 2;
    if (const auto zero = halves.right.first_zero(tolerance, halvings - 1)) return (1 + *zero) / 2;
    return std::nullopt;
  }

 private:
  /// Returns the zero of a polynomial that is positive at 0 and not positive at 1. Uses Newton's
  /// method with bisection.
  double only_zero() const {
    constexpr double rounding = 1e-15;
    double low = 0, high = 1, t = std::max(0.0, c[0] / (c[0] - c[size - 1]));
    for (int i = 0; i < 100; ++i) {
      const auto [value, derivative] = value_and_derivative(t);
      const double step = -value / derivative;
      if (std::abs(step) <= rounding) break;
      (value > 0 ? low : high) = t;
      t += step;
      if (!(t > low && t < high)) t = (low + high) / 2;
    }
    return t;
  }
  struct At {
    double value, derivative;
  };
  At value_and_derivative(double t) const {
    std::array<double, size> of = c;
    for (std::size_t last = size - 1; last > 1; --last)
      for (std::size_t i = 0; i < last; ++i) of[i] += t * (of[i + 1] - of[i]);
    const double derivative = of[1] - of[0];
    return {of[0] + t * derivative, (size - 1) * derivative};
  }
};

/// The 64 coefficients of the cubic B-splines that are nonzero in a cell of a grid. Positions are
/// in units of the cell, relative to its low corner.
struct SplineCell {
  using Four = Eigen::Array4d;
  /// Coefficients of the splines: row 4 i + j contains the four coefficients along z with number i
  /// along x and number j along y.
  std::array<Four, 16> rows;

  /// Returns the Bernstein coefficients of the spline in this cell. All values in the cell are
  /// within their range.
  SplineCell bezier() const {
    SplineCell to = *this;
    for (int along = 0; along < 2; ++along) {
      const int step = along == 0 ? 4 : 1, other = 5 - step;
      for (int i = 0; i < 4; ++i) {
        Four* const first = &to.rows[i * other];
        bezier(first[0], first[step], first[2 * step], first[3 * step]);
      }
    }
    for (Four& row : to.rows) bezier(row[0], row[1], row[2], row[3]);
    return to;
  }
  bool touches_zero(double slack) const {
    const auto [low, high] = range();
    return low <= slack && high >= -slack;
  }
  /// Returns an upper bound of |gradient|^2 of the spline in the cell.
  double largest_squared_gradient() const {
    Vec3 most = Vec3::Zero();
    for (int row = 0; row < 16; ++row) {
      if (row < 12) most[0] = std::max(most[0], (rows[row + 4] - rows[row]).abs().maxCoeff());
      if (row % 4 < 3) most[1] = std::max(most[1], (rows[row + 1] - rows[row]).abs().maxCoeff());
      most[2] = std::max(most[2], (rows[row].tail<3>() - rows[row].head<3>()).abs().maxCoeff());
    }
    return most.squaredNorm();
  }

  /// Returns the fraction of the cell where the spline is negative, computed along lines in the
  /// direction of its largest change.
  double negative_share() const {
    constexpr int lines = 4;
    const std::array<double, 3> variations{
        std::abs((rows[9] + rows[10] - rows[5] - rows[6]).segment<2>(1).sum()),
        std::abs((rows[6] + rows[10] - rows[5] - rows[9]).segment<2>(1).sum()),
        std::abs((rows[5] + rows[6] + rows[9] + rows[10])[2] -
                 (rows[5] + rows[6] + rows[9] + rows[10])[1])};
    const auto axis = std::max_element(variations.begin(), variations.end()) - variations.begin();
    double sum = 0;
    for (int line = 0; line < lines * lines; ++line) {
      Vec3 from = Vec3::Zero();
      from[(axis + 1) % 3] = (line / lines + 0.5) / lines;
      from[(axis + 2) % 3] = (line % lines + 0.5) / lines;
      sum += along(from, from + Vec3::Unit(axis)).negative_share();
    }
    return sum / (lines * lines);
  }

  /// Returns the spline along the line from one point of the cell to another, as a polynomial.
  Bernstein<10> along(const Vec3& from, const Vec3& to) const {
    const Splines x = splines(from[0], to[0]), y = splines(from[1], to[1]),
                  z = splines(from[2], to[2]);
    // Element s has degree s in x and y together; its entries have degrees 0 to 3 in z
    std::array<Four, 7> sums;
    sums.fill(Four::Zero());
    for (int i = 0; i < 4; ++i) {
      std::array<Four, 4> plane;
      plane.fill(Four::Zero());
      for (int j = 0; j < 4; ++j) {
        const Four& c = rows[4 * i + j];
        const Four row = c[0] * z[0] + c[1] * z[1] + c[2] * z[2] + c[3] * z[3];
        for (int m = 0; m < 4; ++m) plane[m] += y[j][m] * row;
      }
      for (int l = 0; l < 4; ++l)
        for (int m = 0; m < 4; ++m) sums[l + m] += x[i][l] * plane[m];
    }
    constexpr double per_binomial[] = {1,        1 / 9.,  1 / 36., 1 / 84., 1 / 126.,
                                       1 / 126., 1 / 84., 1 / 36., 1 / 9.,  1};
    Bernstein<10> polynomial{};
    for (int s = 0; s < 7; ++s)
      for (int k = 0; k < 4; ++k) polynomial.c[s + k] += sums[s][k];
    for (int k = 0; k < 10; ++k) polynomial.c[k] *= per_binomial[k];
    return polynomial;
  }

 private:
  struct Range {
    double low, high;
  };
  Range range() const {
    Four low = rows[0], high = rows[0];
    for (const Four& row : rows) {
      low = low.min(row);
      high = high.max(row);
    }
    return {low.minCoeff(), high.maxCoeff()};
  }
  template <class Number>
  static void bezier(Number& a, Number& b, Number& c, Number& d) {
    const Number first = (a + 4 * b + c) / 6, last = (b + 4 * c + d) / 6;
    const Number second = (2 * b + c) / 3, third = (b + 2 * c) / 3;
    a = first;
    b = second;
    c = third;
    d = last;
  }
  /// Returns the four splines that are nonzero between two positions along an axis, as Bernstein
  /// coefficients times binomial coefficients. They are computed from polar forms.
  using Splines = std::array<Four, 4>;
  static Splines splines(double a, double b) {
    const double p = 1 - a, q = 1 - b;
    const Four up(a * a * a, 3 * a * a * b, 3 * a * b * b, b * b * b);
    const Four down(p * p * p, 3 * p * p * q, 3 * p * q * q, q * q * q);
    const Four ones(1, 3, 3, 1);
    const Four square(a * a, a * a + 2 * a * b, 2 * a * b + b * b, b * b);
    const Four other(p * p, p * p + 2 * p * q, 2 * p * q + q * q, q * q);
    return {down / 6, 2 / 3. * ones - square + up / 2, 2 / 3. * ones - other + down / 2, up / 6};
  }
};

}  // namespace flatspeckle::grin
