#include "flatland/scatterers/scatterer.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <utility>

#include "core/contract.h"
#include "core/error.h"
#include "flatland/scatterers/scatterer_kinds.h"

namespace flatspeckle {

namespace {

// Returns the sum over n = -M .. M of terms that are even in n, with M the highest order of t.
template <typename Term>
auto two_sided_sum(const std::vector<ExtendedComplex>& t, Term term) {
  auto sum = term(0);
  for (std::size_t n = 1; n < t.size(); ++n) sum += 2.0L * term(static_cast<int>(n));
  return sum;
}

/// Clenshaw's recurrence for sum c_n cos(n theta), b_n = c_n + 2 cos(theta) b_{n+1} - b_{n+2}, for
/// several angles at once. Rounding errors grow as the order squared, to 1e-12 at order 100.
struct ClenshawBlock {
  static constexpr std::size_t size = 64;
  using Row = std::array<double, size>;
  Row cosine{}, real{}, imaginary{}, last_real{}, last_imaginary{};

  void step(Complex c) {
    for (std::size_t i = 0; i < size; ++i) {
      const double next_real = c.real() + 2 * cosine[i] * real[i] - last_real[i];
      const double next_imaginary = c.imag() + 2 * cosine[i] * imaginary[i] - last_imaginary[i];
      last_real[i] = real[i];
      last_imaginary[i] = imaginary[i];
      real[i] = next_real;
      imaginary[i] = next_imaginary;
    }
  }
  /// Returns the sum at angle i, c_0 + cos(theta) b_1 - b_2. c: c_0.
  Complex sum(Complex c, std::size_t i) const {
    return c + Complex(cosine[i] * real[i] - last_real[i],
                       cosine[i] * imaginary[i] - last_imaginary[i]);
  }
};

/// Returns the factor by which the sum of T_n cos(n theta) is multiplied to give the amplitude
/// (C6).
Complex far_field_factor(double k) {
  return std::polar(std::sqrt(2 / (std::numbers::pi * k)), -std::numbers::pi / 4);
}

}  // namespace

std::string index_fault(Complex index) {
  if (index == 0.0 || index.imag() < 0)
    return "must not be 0 and must not amplify (a positive imaginary part absorbs)";
  if (index.real() < 0) return "must not have a negative real part";
  return "";
}

std::vector<ScaledComplex> scaled_t_matrix(const Scatterer& scatterer, double k, int order,
                                           Radial kind) {
  FS_EXPECT(!scatterer.is_bulk());
  return kind_of(scatterer).t_matrix(scatterer, k * scatterer.radius, order, kind);
}

std::vector<ExtendedComplex> t_matrix(const Scatterer& scatterer, double k, int order,
                                      Radial kind) {
  const auto scaled = scaled_t_matrix(scatterer, k, order, kind);
  std::vector<ExtendedComplex> t;
  for (const ScaledComplex& t_n : scaled) t.push_back(static_cast<ExtendedComplex>(t_n));
  return t;
}

int oscillating_order(const Scatterer& scatterer, double k) {
  if (!scatterer.is_disk()) return 0;
  const double index = scatterer.is_penetrable() ? std::max(1.0, std::abs(scatterer.index)) : 1.0;
  const double size = k * scatterer.radius * index;
  constexpr double most = 1e4;
  if (!(size <= most))
    throw InputError("radius", scatterer.radius,
                     "k radius |index| is " + std::to_string(size) + "; it must be at most 10000");
  return static_cast<int>(std::ceil(size));
}

int isolated_order(const Scatterer& scatterer, double k, double tolerance, Radial kind) {
  if (!scatterer.is_disk()) return 0;
  for (int size = oscillating_order(scatterer, k) + 8;; size *= 2) {
    const auto t = t_matrix(scatterer, k, size, kind);
    long double largest = 0;
    for (const auto& t_n : t) largest = std::max(largest, std::abs(t_n));
    int order = size;
    while (order > 0 && std::abs(t[order]) <= tolerance * largest) --order;
    if (order < size) return order;
  }
}

CrossSections cross_sections(const std::vector<ExtendedComplex>& t, double k) {
  const long double scattered = two_sided_sum(t, [&](int n) { return std::norm(t[n]); });
  const long double lost = -two_sided_sum(t, [&](int n) { return t[n].real(); });
  long double cosine = 0;
  for (std::size_t n = 0; n + 1 < t.size(); ++n) cosine += 2 * (t[n] * std::conj(t[n + 1])).real();
  const double g = scattered > 0 ? static_cast<double>(cosine / scattered) : 0;
  // No scatterer has gain. Without absorption, extinction and scattering differ only by rounding.
  const long double extinction = std::max(lost, scattered);
  return {static_cast<double>(4 * scattered / k), static_cast<double>(4 * extinction / k), g};
}

Complex amplitude(const std::vector<ExtendedComplex>& t, double k, double theta) {
  const ExtendedComplex sum =
      two_sided_sum(t, [&](int n) { return t[n] * static_cast<long double>(std::cos(n * theta)); });
  return far_field_factor(k) * Complex(sum);
}

std::vector<Complex> amplitudes(const std::vector<ExtendedComplex>& t, double k,
                                std::size_t intervals) {
  std::vector<Complex> values(intervals + 1);
  for (std::size_t first = 0; first <= intervals; first += ClenshawBlock::size) {
    ClenshawBlock block;
    for (std::size_t i = 0; i < ClenshawBlock::size; ++i)
      block.cosine[i] = std::cos(std::numbers::pi * static_cast<double>(first + i) /
                                 static_cast<double>(intervals));
    for (std::size_t n = t.size() - 1; n > 0; --n) block.step(2.0 * Complex(t[n]));
    const std::size_t count = std::min(ClenshawBlock::size, intervals + 1 - first);
    for (std::size_t i = 0; i < count; ++i)
      values[first + i] = far_field_factor(k) * block.sum(Complex(t[0]), i);
  }
  return values;
}

CrossSections cross_sections_in_space(const std::vector<ExtendedComplex>& t, double k) {
  long double scattered = 0, lost = 0, cosine = 0;
  for (std::size_t l = 0; l < t.size(); ++l) {
    const auto many = static_cast<long double>(2 * l + 1), next = static_cast<long double>(l + 1);
    scattered += many * std::norm(t[l]);
    lost -= many * t[l].real();
    if (l + 1 < t.size()) cosine += 2 * next * (t[l] * std::conj(t[l + 1])).real();
  }
  const long double unit = 4 * std::numbers::pi_v<long double> / (static_cast<long double>(k) * k);
  return {static_cast<double>(unit * scattered),
          static_cast<double>(unit * std::max(lost, scattered)),
          scattered > 0 ? static_cast<double>(cosine / scattered) : 0};
}

Complex amplitude_in_space(const std::vector<ExtendedComplex>& t, double k, double cosine) {
  long double before = 0, legendre = 1;
  ExtendedComplex sum = 0;
  for (std::size_t l = 0; l < t.size(); ++l) {
    sum += static_cast<long double>(2 * l + 1) * legendre * t[l];
    const auto next = (static_cast<long double>(2 * l + 1) * cosine * legendre -
                       static_cast<long double>(l) * before) /
                      static_cast<long double>(l + 1);
    before = std::exchange(legendre, next);
  }
  return Complex(0, -1 / k) * Complex(sum);
}

std::vector<Complex> amplitudes_in_space(const std::vector<ExtendedComplex>& t, double k) {
  const std::size_t intervals = 2048 * std::max<std::size_t>(t.size(), 1);
  std::vector<Complex> values;
  for (std::size_t i = 0; i <= intervals; ++i)
    values.push_back(amplitude_in_space(
        t, k,
        std::cos(std::numbers::pi * static_cast<double>(i) / static_cast<double>(intervals))));
  return values;
}

}  // namespace flatspeckle
