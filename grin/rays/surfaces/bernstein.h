#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <optional>

namespace flatspeckle::grin {

/// A polynomial on [0, 1] by its Bernstein coefficients: nowhere outside of their range, and with
/// no more zeros than they change sign.
template <std::size_t size>
struct Bernstein {
  std::array<double, size> c;

  struct Halves {
    Bernstein left, right;
  };
  /// At t, by de Casteljau; the value there is right.c[0].
  Halves split(double t) const {
    Halves halves{{}, *this};
    for (std::size_t last = size; last-- > 0;) {
      halves.left.c[size - 1 - last] = halves.right.c[0];
      for (std::size_t i = 0; i < last; ++i)
        halves.right.c[i] += t * (halves.right.c[i + 1] - halves.right.c[i]);
    }
    return halves;
  }

  /// Of [0, 1] where it is negative.
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

  /// (p(t) - p(0)) / t.
  Bernstein<size - 1> without_zero_at_start() const {
    constexpr double degree = size - 1;
    Bernstein<size - 1> rest;
    for (std::size_t i = 0; i + 1 < size; ++i)
      rest.c[i] = (c[i + 1] - c[0]) * degree / static_cast<double>(i + 1);
    return rest;
  }

  /// Where a polynomial that is positive at 0 first changes its sign; what is above -tolerance
  /// counts as positive. Two zeros nearer to each other than 2^-24 may be missed.
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
  /// Between a positive start and an end that is not: Newton's steps, or halves of the bracket.
  double only_zero() const {
    constexpr double rounding = 1e-15;
    double low = 0, high = 1, t = std::max(0.0, c[0] / (c[0] - c[size - 1]));
    for (int i = 0; i < 100; ++i) {
      const auto [value, slope] = value_and_slope(t);
      const double step = -value / slope;
      if (std::abs(step) <= rounding) break;
      (value > 0 ? low : high) = t;
      t += step;
      if (!(t > low && t < high)) t = (low + high) / 2;
    }
    return t;
  }
  struct At {
    double value, slope;
  };
  At value_and_slope(double t) const {
    std::array<double, size> of = c;
    for (std::size_t last = size - 1; last > 1; --last)
      for (std::size_t i = 0; i < last; ++i) of[i] += t * (of[i + 1] - of[i]);
    const double slope = of[1] - of[0];
    return {of[0] + t * slope, (size - 1) * slope};
  }
};

}  // namespace flatspeckle::grin
