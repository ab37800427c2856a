#pragma once

#include <bit>
#include <cmath>
#include <complex>
#include <cstdint>
#include <memory>
#include <vector>

#include "core/numbers/wide/four.h"
#include "grin/media/index/lanes.h"
#include "grin/media/index/sound.h"

namespace flatspeckle::grin {

/// The function g_m(u) = J_m(x) / x^m with u = x^2, where J_m is the Bessel function of order m. It
/// is entire in u, so that J_m(x) cos(m phi) = g_m(u) Re (x e^{i phi})^m is smooth on the axis for
/// every m. Its derivative with respect to u is g_m' = -g_{m+1}/2.
///
/// Up to x = reach, g_m is evaluated from a table of polynomials in u, one for each of many equal
/// steps in x; beyond the reach, by the slower functions of the C library. Errors, relative to the
/// envelope of J_m: value 1e-15, derivative 1e-13. All profiles of an order share one table,
/// because computing a table takes longer than tracing many rays.
class BesselProfile {
 public:
  static constexpr int max_order = 64;

  /// order: from 0 to max_order. Throws InputError for a reach that is not in (0, 1e4].
  BesselProfile(int order, double reach);

  int order() const { return order_; }
  double reach() const { return reach_; }

  struct Jet {
    double value, derivative;
  };
  double value(double u) const { return jet(u).value; }
  /// Returns g_m and its derivative with respect to u.
  Jet jet(double u) const {
    const double place = std::sqrt(u) * cells_per_unit;
    if (!(place < cells_)) return far_jet(u);
    const double cell = std::rint(place);
    return polynomial(cells()[static_cast<std::size_t>(cell)], u - centre(cell));
  }
  /// Computes jet(u) in all SIMD lanes; the result is NaN in lanes beyond the reach. The arrays
  /// must be aligned.
  void jets(const double* u, double* value, double* derivative) const {
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
      polynomials(rows, wide_four_at(delta + k), wide_four_at(value + k),
                  wide_four_at(derivative + k));
    }
  }
  /// The value g, its first derivative g' and its second derivative g'' with respect to u. For u >
  /// 4 (m + 1), g'' follows from Bessel's equation, 4 u g'' = -4 (m + 1) g' - g. For smaller u the
  /// terms of this equation cancel, and the table is used.
  struct SecondOrderJet : Jet {
    double second_derivative;
  };
  SecondOrderJet second_order_jet(double u) const {
    const double place = std::sqrt(u) * cells_per_unit;
    if (!(place < cells_)) return by_bessel_equation(far_jet(u), u);
    const double cell = std::rint(place);
    const Cell& in = cells()[static_cast<std::size_t>(cell)];
    const double t = u - centre(cell);
    const Jet at = polynomial(in, t);
    return u > 4 * (order_ + 1) ? by_bessel_equation(at, u)
                                : SecondOrderJet{at, second_derivative(in, t)};
  }

 private:
  static constexpr int degree = 7;
  static constexpr double cells_per_unit = 8;
  struct alignas(64) Cell {
    double c[degree + 1];
  };

  /// Adding this constant to a number rounds it to an integer, which is then in the lowest bits of
  /// the sum.
  static constexpr double nearest = 0x1.8p52;
  /// Returns the u about which the polynomial of a cell is expanded, near the middle of the cell.
  static double centre(double cell) {
    return (cell * cell + 0.5) / (cells_per_unit * cells_per_unit);
  }
  /// Evaluates the polynomial of a cell and its derivative by Estrin's scheme, which has a short
  /// chain of dependent operations.
  static Jet polynomial(const Cell& cell, double t) {
    const double* c = cell.c;
    const double t2 = t * t, t4 = t2 * t2;
    const double value = ((c[0] + c[1] * t) + (c[2] + c[3] * t) * t2) +
                         ((c[4] + c[5] * t) + (c[6] + c[7] * t) * t2) * t4;
    const double derivative = ((c[1] + 2 * c[2] * t) + (3 * c[3] + 4 * c[4] * t) * t2) +
                              ((5 * c[5] + 6 * c[6] * t) + 7 * c[7] * t2) * t4;
    return {value, derivative};
  }
  /// Evaluates the polynomials of four cells and their derivatives by Horner's scheme.
  [[gnu::always_inline]] static void polynomials(const double* const (&rows)[4], const WideFour& t,
                                                 WideFour& value, WideFour& derivative) {
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
    derivative = d;
  }
  static double second_derivative(const Cell& cell, double t) {
    const double* c = cell.c;
    const double t2 = t * t;
    return ((2 * c[2] + 6 * c[3] * t) + (12 * c[4] + 20 * c[5] * t) * t2) +
           (30 * c[6] + 42 * c[7] * t) * t2 * t2;
  }
  SecondOrderJet by_bessel_equation(const Jet& at, double u) const {
    return {at, -((order_ + 1) * at.derivative + at.value / 4) / u};
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
  std::shared_ptr<const Table> table_;  ///< table of polynomials for at least cells_ cells
};

/// Sound in the form of a cylindrical standing wave about the z axis, at a fixed phase
/// (conventions, C28): n = 1 + background + amplitude S J_m(kr rho) cos(m phi), where S is the
/// cosine of the phase.
class StandingWave {
 public:
  /// Requires kr > 0. Evaluation is fast up to rho = reach, slow but correct beyond. Throws
  /// InputError if kr * reach is not in (0, 1e4].
  StandingWave(double background, double amplitude, int m, double kr, double reach);

  /// Returns the wave scaled by the phase factor S, from -1 to 1. The copy shares the table of the
  /// Bessel function.
  StandingWave frozen(double s) const {
    StandingWave wave = *this;
    wave.amplitude_ *= s;
    return wave;
  }

  double background() const { return background_; }
  double amplitude() const { return amplitude_; }
  double wavenumber() const { return kr_; }
  int order() const { return m_; }

  double excess(const Vec3& x) const {
    const double u = kr_ * kr_ * (x[0] * x[0] + x[1] * x[1]);
    return background_ + amplitude_ * profile_->value(u) * power(x, m_).real();
  }

  IndexGradient gradient(const Vec3& x) const {
    const double u = kr_ * kr_ * (x[0] * x[0] + x[1] * x[1]);
    const auto [value, derivative] = profile_->jet(u);
    const double radial = 2 * amplitude_ * kr_ * kr_ * derivative;
    if (m_ == 0) return {background_ + amplitude_ * value, Vec3(radial * x[0], radial * x[1], 0)};
    // The derivative of z^m with respect to z = kr (x + i y) is m z^(m-1). Multiplied by kr, its
    // real part is d/dx of Re z^m, and minus its imaginary part is d/dy of Re z^m.
    const std::complex<double> lower = power(x, m_ - 1);
    const double re = kr_ * (x[0] * lower.real() - x[1] * lower.imag());
    const double turn = amplitude_ * value * m_ * kr_;
    return {background_ + amplitude_ * value * re,
            Vec3(radial * re * x[0] + turn * lower.real(), radial * re * x[1] - turn * lower.imag(),
                 0)};
  }

  void gradients(const LaneVectors& x, LaneGradients& found) const {
    const double amplitude = amplitude_, background = background_, k2 = kr_ * kr_;
    alignas(64) double u[lanes], value[lanes], derivative[lanes];
#pragma omp simd
    for (int k = 0; k < lanes; ++k) u[k] = k2 * (x.x[k] * x.x[k] + x.y[k] * x.y[k]);
    profile_->jets(u, value, derivative);
    if (m_ > 0) return angular_gradients(x, value, derivative, found);
#pragma omp simd
    for (int k = 0; k < lanes; ++k) {
      const double radial = 2 * amplitude * k2 * derivative[k];
      found.excess[k] = background + amplitude * value[k];
      found.gradient.x[k] = radial * x.x[k];
      found.gradient.y[k] = radial * x.y[k];
      found.gradient.z[k] = 0;
    }
  }

  IndexHessian hessian(const Vec3& x) const {
    return m_ == 0 ? round_hessian(x) : angular_hessian(x);
  }

 private:
  /// Returns the Hessian for order m = 0, 2 g' delta_ij + 4 g'' x_i x_j.
  IndexHessian round_hessian(const Vec3& x) const {
    const double a = kr_ * x[0], b = kr_ * x[1];
    const auto at = profile_->second_order_jet(a * a + b * b);
    const double scale = amplitude_ * kr_ * kr_, derivative = 2 * scale * at.derivative;
    const double second_derivative = 4 * scale * at.second_derivative;
    IndexHessian found{background_ + amplitude_ * at.value,
                       {derivative * x[0], derivative * x[1], 0},
                       Mat3::Zero()};
    found.hessian(0, 0) = derivative + second_derivative * a * a;
    found.hessian(1, 1) = derivative + second_derivative * b * b;
    found.hessian(0, 1) = found.hessian(1, 0) = second_derivative * a * b;
    return found;
  }
  IndexHessian angular_hessian(const Vec3& x) const;
  /// Computes gradient() in lanes for order m > 0.
  void angular_gradients(const LaneVectors& x, const double* value, const double* derivative,
                         LaneGradients& found) const {
    const double amplitude = amplitude_, background = background_, kr = kr_, m = m_;
    alignas(64) double re[lanes], im[lanes], a[lanes], b[lanes];
#pragma omp simd
    for (int k = 0; k < lanes; ++k) {
      re[k] = 1;
      im[k] = 0;
      a[k] = kr * x.x[k];
      b[k] = kr * x.y[k];
    }
    for (int exponent = m_ - 1; exponent > 0; exponent >>= 1) {
      const bool is_odd = exponent & 1;
#pragma omp simd
      for (int k = 0; k < lanes; ++k) {
        const double next = re[k] * a[k] - im[k] * b[k], side = re[k] * b[k] + im[k] * a[k];
        re[k] = is_odd ? next : re[k];
        im[k] = is_odd ? side : im[k];
        const double square = a[k] * a[k] - b[k] * b[k];
        b[k] *= 2 * a[k];
        a[k] = square;
      }
    }
#pragma omp simd
    for (int k = 0; k < lanes; ++k) {
      const double whole = kr * (x.x[k] * re[k] - x.y[k] * im[k]);
      const double turn = amplitude * value[k] * m * kr;
      const double radial = 2 * amplitude * kr * kr * derivative[k] * whole;
      found.excess[k] = background + amplitude * value[k] * whole;
      found.gradient.x[k] = radial * x.x[k] + turn * re[k];
      found.gradient.y[k] = radial * x.y[k] - turn * im[k];
      found.gradient.z[k] = 0;
    }
  }

  /// Returns (kr (x + i y))^exponent, by squaring.
  std::complex<double> power(const Vec3& x, int exponent) const {
    double re = 1, im = 0, a = kr_ * x[0], b = kr_ * x[1];
    for (; exponent > 0; exponent >>= 1) {
      if (exponent & 1) {
        const double next = re * a - im * b;
        im = re * b + im * a;
        re = next;
      }
      const double square = a * a - b * b;
      b *= 2 * a;
      a = square;
    }
    return {re, im};
  }

  double background_, amplitude_, kr_;
  int m_;
  std::shared_ptr<const BesselProfile> profile_;
};

/// Returns the wave at this phase of the sound, from 0 to 2 pi: S = cos(phase).
inline StandingWave at_phase(const StandingWave& field, double phase) {
  return field.frozen(std::cos(phase));
}

inline FieldFacts facts(const StandingWave& field) {
  return {.scale = 1 / field.wavenumber(),
          .strength = std::abs(field.amplitude()),
          .symmetry = field.order() == 0 ? Symmetry::round_guide : Symmetry::guide};
}

struct UltrasoundValues : SoundValues {
  using Field = StandingWave;
  static constexpr const char* word = "ultrasound";
  std::int64_t sound_order = 0;
};

void add_keys(Keys& keys, UltrasoundValues& values);
StandingWave make_field(const Keys& keys, const UltrasoundValues& values, const FieldUse& use);

}  // namespace flatspeckle::grin
