#pragma once

#include <algorithm>
#include <array>

#include <Eigen/Core>

#include "grin/media/geometry/vec3.h"
#include "grin/rays/surfaces/bernstein.h"

namespace flatspeckle::grin {

/// The 64 coefficients of the cubic B-splines that are there in a cell of a grid, whose places are
/// in units of the cell, from its low corner.
struct SplineCell {
  using Four = Eigen::Array4d;
  std::array<Four, 16> rows;  ///< along z; y fastest

  /// As Bernstein polynomials, within whose coefficients values are.
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
  /// |gradient| squared is nowhere more than this.
  double most_squared_slope() const {
    Vec3 most = Vec3::Zero();
    for (int row = 0; row < 16; ++row) {
      if (row < 12) most[0] = std::max(most[0], (rows[row + 4] - rows[row]).abs().maxCoeff());
      if (row % 4 < 3) most[1] = std::max(most[1], (rows[row + 1] - rows[row]).abs().maxCoeff());
      most[2] = std::max(most[2], (rows[row].tail<3>() - rows[row].head<3>()).abs().maxCoeff());
    }
    return most.squaredNorm();
  }

  /// Of the cell, along lines in the direction in which the sum changes most.
  double negative_share() const {
    constexpr int lines = 4;
    const std::array<double, 3> slopes{
        std::abs((rows[9] + rows[10] - rows[5] - rows[6]).segment<2>(1).sum()),
        std::abs((rows[6] + rows[10] - rows[5] - rows[9]).segment<2>(1).sum()),
        std::abs((rows[5] + rows[6] + rows[9] + rows[10])[2] -
                 (rows[5] + rows[6] + rows[9] + rows[10])[1])};
    const auto axis = std::max_element(slopes.begin(), slopes.end()) - slopes.begin();
    double sum = 0;
    for (int line = 0; line < lines * lines; ++line) {
      Vec3 from = Vec3::Zero();
      from[(axis + 1) % 3] = (line / lines + 0.5) / lines;
      from[(axis + 2) % 3] = (line % lines + 0.5) / lines;
      sum += along(from, from + Vec3::Unit(axis)).negative_share();
    }
    return sum / (lines * lines);
  }

  /// From one place in it to another.
  Bernstein<10> along(const Vec3& from, const Vec3& to) const {
    const Splines x = splines(from[0], to[0]), y = splines(from[1], to[1]),
                  z = splines(from[2], to[2]);
    std::array<Four, 7> sums;  // by the degrees in x and y together, along those in z
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
  /// The four that are there, between two places of an axis: Bernstein coefficients times
  /// binomials, from polar forms.
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
