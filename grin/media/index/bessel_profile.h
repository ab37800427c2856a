#pragma once

#include <bit>
#include <cmath>
#include <cstdint>
#include <memory>
#include <vector>

#include "core/numbers/wide/four.h"
#include "grin/media/index/lanes.h"

namespace flatspeckle::grin {

/// g_m(u) = J_m(x) / x^m with u = x^2: entire in u, so that J_m(x) cos(m phi) = g_m(u) Re (x e^{i
/// phi})^m is smooth on the axis for every m. By u, g_m' = -g_{m+1}/2.
///
/// A table of polynomials in u over equal steps in x, up to x = reach; beyond, those of the C
/// library, slowly. Errors, relative to the envelope of J_m: value 1e-15, slope 1e-13. All of an
/// order share one table, which takes longer to make than many rays to follow.
class BesselProfile {
 public:
  static constexpr int max_order = 64;

  /// Order 0 to max_order. Throws InputError for a reach that is not in (0, 1e4].
  BesselProfile(int order, double reach);

  int order() const { return order_; }
  double reach() const { return reach_; }

  struct Jet {
    double value, slope;
  };
  double value(double u) const { return jet(u).value; }
  /// g_m and its derivative by u.
  Jet jet(double u) const {
    const double place = std::sqrt(u) * cells_per_unit;
    if (!(place < cells_)) return far_jet(u);
    const double cell = std::rint(place);
    return polynomial(cells()[static_cast<std::size_t>(cell)], u - centre(cell));
  }
  /// The same of u in lanes, which are aligned; NaN beyond the reach.
  void jets(const double* u, double* value, double* slope) const {
    alignas(64) double delta[lanes], number[lanes];
    const double count = cells_;
    const Cell* const table = cells();
#pragma omp simd
    for (int k = 0; k < lanes; ++k) {
      const double place = std::sqrt(u[k]) * cells_per_unit;
      const bool is_near = place < count;
      number[k] = (is_near ? place : 0) + nearest;
      delta[k] = is_near ? u[k] - centre(number[k] - nearest) : NAN;
    }
    for (int k = 0; k < lanes; k += 4) {
      const double* rows[4];
      for (int i = 0; i < 4; ++i)
        rows[i] = table[static_cast<std::int32_t>(std::bit_cast<std::int64_t>(number[k + i]))].c;
      polynomials(rows, wide_four_at(delta + k), wide_four_at(value + k), wide_four_at(slope + k));
    }
  }
  /// And the second: where x is past the first bend from Bessel's equation, 4 u g'' = -4 (m + 1)
  /// g' - g; it would cancel before, where the table's polynomials converge fastest.
  struct BentJet : Jet {
    double bend;
  };
  BentJet bent_jet(double u) const {
    const double place = std::sqrt(u) * cells_per_unit;
    if (!(place < cells_)) return bent(far_jet(u), u);
    const double cell = std::rint(place);
    const Cell& in = cells()[static_cast<std::size_t>(cell)];
    const double t = u - centre(cell);
    const Jet at = polynomial(in, t);
    return u > 4 * (order_ + 1) ? bent(at, u) : BentJet{at, bend(in, t)};
  }

 private:
  static constexpr int degree = 7;
  static constexpr double cells_per_unit = 8;
  struct alignas(64) Cell {
    double c[degree + 1];
  };

  /// Added to a number it is rounded to a whole one, which the lowest bits then are.
  static constexpr double nearest = 0x1.8p52;
  /// In u; about the middle of the cell of what is nearest to it in steps of x.
  static double centre(double cell) {
    return (cell * cell + 0.5) / (cells_per_unit * cells_per_unit);
  }
  /// Estrin's scheme: a short chain of dependent operations.
  static Jet polynomial(const Cell& cell, double t) {
    const double* c = cell.c;
    const double t2 = t * t, t4 = t2 * t2;
    const double value = ((c[0] + c[1] * t) + (c[2] + c[3] * t) * t2) +
                         ((c[4] + c[5] * t) + (c[6] + c[7] * t) * t2) * t4;
    const double slope = ((c[1] + 2 * c[2] * t) + (3 * c[3] + 4 * c[4] * t) * t2) +
                         ((5 * c[5] + 6 * c[6] * t) + 7 * c[7] * t2) * t4;
    return {value, slope};
  }
  /// Horner's, of four cells.
  [[gnu::always_inline]] static void polynomials(const double* const (&rows)[4], const WideFour& t,
                                                 WideFour& value, WideFour& slope) {
    WideFour c[degree + 1];
    for (int i = 0; i < 4; ++i) {
      c[i] = wide_four_at(rows[i]);
      c[i + 4] = wide_four_at(rows[i] + 4);
    }
    transpose(c);
    transpose(c + 4);
    WideFour v = c[degree], d = v;
    for (int i = degree - 1; i > 0; --i) {
      v = v * t + c[i];
      d = d * t + v;
    }
    value = v * t + c[0];
    slope = d;
  }
  static double bend(const Cell& cell, double t) {
    const double* c = cell.c;
    const double t2 = t * t;
    return ((2 * c[2] + 6 * c[3] * t) + (12 * c[4] + 20 * c[5] * t) * t2) +
           (30 * c[6] + 42 * c[7] * t) * t2 * t2;
  }
  BentJet bent(const Jet& at, double u) const {
    return {at, -((order_ + 1) * at.slope + at.value / 4) / u};
  }
  const Cell* cells() const {
    return table_->data();
  }
  static Cell fit(int order, double cell);
  using Table = std::vector<Cell>;
  static std::shared_ptr<const Table> table_of(int order, std::size_t cells);
  Jet far_jet(double u) const;

  int order_;
  double reach_, cells_;
  std::shared_ptr<const Table> table_;  ///< of these cells or more
};

}  // namespace flatspeckle::grin
