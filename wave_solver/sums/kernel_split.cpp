#include "wave_solver/sums/kernel_split.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/numbers/hankel_array.h"
#include "core/numbers/wide/every_width.h"
#include "core/numbers/wide/functions.h"

namespace flatspeckle::wave {

namespace {

// Returns the coefficients of the Chebyshev series that interpolates values[j] at cos(pi (j + 1/2)
// / n).
std::vector<double> chebyshev_series(const std::vector<double>& values) {
  const std::size_t n = values.size();
  std::vector<double> series(n);
  for (std::size_t m = 0; m < n; ++m) {
    double sum = 0;
    for (std::size_t j = 0; j < n; ++j)
      sum += values[j] * std::cos(std::numbers::pi * static_cast<double>(m * (2 * j + 1)) /
                                  static_cast<double>(2 * n));
    series[m] = (m == 0 ? 1.0 : 2.0) / static_cast<double>(n) * sum;
  }
  return series;
}

FLATSPECKLE_EVERY_WIDTH void spherical_wave(const double* x, Complex* h, std::size_t count) {
  auto* parts = reinterpret_cast<double*>(h);
#pragma omp simd
  for (std::size_t i = 0; i < count; ++i) {
    const auto [sine, cosine] = wide_sine_cosine(x[i]);
    parts[2 * i] = sine / x[i];
    parts[2 * i + 1] = -cosine / x[i];
  }
}

}  // namespace

void outgoing_wave(Radial kind, std::span<const double> x, std::span<Complex> h) {
  kind == Radial::cylindrical ? hankel0(x, h) : spherical_wave(x.data(), h.data(), x.size());
}

double bump(double beta, double t) {
  const double inside = 1 - t * t;
  return inside > 0 ? std::exp(beta * (std::sqrt(inside) - 1)) : 0;
}

Quadrature double_exponential_rule(double frequency) {
  constexpr double reach = 3.1, quarter_turn = std::numbers::pi / 2;
  const int half_size = static_cast<int>(60 + 3 * frequency);
  const double step = reach / half_size;
  Quadrature rule;
  for (int i = -half_size; i <= half_size; ++i) {
    const double t = step * i, cosh_u = std::cosh(quarter_turn * std::sinh(t));
    rule.nodes.push_back(std::tanh(quarter_turn * std::sinh(t)));
    rule.weights.push_back(step * quarter_turn * std::cosh(t) / (cosh_u * cosh_u));
  }
  return rule;
}

double bump_exponent(double tolerance) {
  return std::clamp(std::log(1 / tolerance) + 1, 11.0, 35.0);
}

// At the frequency centre + q the transform of the mollifier is about exp(sqrt(beta^2 - (q
// range)^2) - beta) of its peak. With beta^2 = exponent^2 + ((k - centre) range)^2 it falls by the
// factor exp(-exponent) from k to the edge of the band. From `centre` to k it falls by a factor of
// exp(-2) at most.
KernelSplit::Mollifier KernelSplit::mollifier(double k, double range, double tolerance) {
  const double exponent = bump_exponent(tolerance);
  const double offset = std::min(k, 2 * std::sqrt(exponent) / range);
  return {k - offset, std::hypot(exponent, offset * range)};
}

double KernelSplit::band(double k, double range, double tolerance) {
  const Mollifier shape = mollifier(k, range, tolerance);
  return shape.centre + shape.beta / range;
}

KernelSplit::KernelSplit(double k, double range, double tolerance, Radial kind)
    : k_(k), range_(range), kind_(kind), shape_(mollifier(k, range, tolerance)) {
  const double norm = 1 / moment(0, range).real();
  const auto terms = static_cast<std::size_t>(16 + shape_.beta + k * range);
  std::vector<double> values(terms);
  for (std::size_t j = 0; j < terms; ++j) {
    const double u =
        std::cos(std::numbers::pi * (static_cast<double>(j) + 0.5) / static_cast<double>(terms));
    const double r = range * std::sqrt((1 + u) / 2), x[1] = {k * r};
    Complex h[1];
    wave(x, h);
    values[j] = norm * (h[0].imag() * moment(0, r).real() + h[0].real() * moment(r, range).imag());
  }
  chebyshev_ = chebyshev_series(values);
}

// Returns the integral of the mollifier times H_0(k s) s, in space h_0(k s) s^2, over from < s <
// to.
Complex KernelSplit::moment(double from, double to) const {
  const Quadrature rule = double_exponential_rule(shape_.beta + 2 * k_ * range_);
  const double middle = (from + to) / 2, half = (to - from) / 2;
  const std::size_t count = rule.nodes.size();
  std::vector<double> s(count), x(count);
  for (std::size_t i = 0; i < count; ++i) {
    s[i] = middle + half * rule.nodes[i];
    x[i] = k_ * s[i];
  }
  std::vector<Complex> h(count), modulation(count, 1);
  wave(x, h);
  for (std::size_t i = 0; i < count; ++i) x[i] = shape_.centre * s[i];
  if (shape_.centre > 0) wave(x, modulation);
  Complex sum = 0;
  for (std::size_t i = 0; i < count; ++i)
    sum += half * rule.weights[i] * (kind_ == Radial::cylindrical ? s[i] : s[i] * s[i]) *
           bump(shape_.beta, s[i] / range_) * modulation[i].real() * h[i];
  return sum;
}

// Evaluates Im far by Clenshaw's recurrence.
void KernelSplit::smooth_y0(std::span<const double> r, std::span<double> values) const {
  constexpr std::size_t lanes = 64;
  double u[lanes], b1[lanes], b2[lanes];
  for (std::size_t first = 0; first < r.size(); first += lanes) {
    const std::size_t count = std::min(lanes, r.size() - first);
    for (std::size_t i = 0; i < lanes; ++i) {
      const double t = i < count ? std::min(r[first + i] / range_, 1.0) : 0;
      u[i] = 2 * (2 * t * t - 1);
      b1[i] = b2[i] = 0;
    }
    for (std::size_t m = chebyshev_.size() - 1; m > 0; --m)
      for (std::size_t i = 0; i < lanes; ++i) {
        const double b = chebyshev_[m] + u[i] * b1[i] - b2[i];
        b2[i] = b1[i];
        b1[i] = b;
      }
    for (std::size_t i = 0; i < count; ++i)
      values[first + i] = chebyshev_[0] + u[i] / 2 * b1[i] - b2[i];
  }
}

void KernelSplit::near(std::span<const double> r, std::span<double> values) const {
  std::vector<double> x(r.size());
  std::vector<Complex> h(r.size());
  for (std::size_t i = 0; i < r.size(); ++i) x[i] = k_ * (r[i] > 0 ? r[i] : range_);
  wave(x, h);
  smooth_y0(r, values);
  for (std::size_t i = 0; i < r.size(); ++i) {
    if (r[i] >= range_)
      values[i] = 0;
    else
      values[i] = (r[i] > 0 ? h[i].imag() : 0) - values[i];
  }
}

void KernelSplit::far(std::span<const double> r, std::span<Complex> values) const {
  std::vector<double> x(r.size()), smooth(r.size());
  for (std::size_t i = 0; i < r.size(); ++i) x[i] = k_ * (r[i] > 0 ? r[i] : range_);
  wave(x, values);
  smooth_y0(r, smooth);
  for (std::size_t i = 0; i < r.size(); ++i) {
    if (r[i] == 0)
      values[i] = {1, smooth[i]};
    else if (r[i] < range_)
      values[i].imag(smooth[i]);
  }
}

}  // namespace flatspeckle::wave
