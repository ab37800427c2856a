#include "flatland/scatterers/scatterer.h"

#include <algorithm>
#include <array>
#include <cmath>

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

std::vector<ScaledComplex> scaled_t_matrix(const Scatterer& scatterer, double k, int order) {
  FS_EXPECT(!scatterer.is_bulk());
  return kind_of(scatterer).t_matrix(scatterer, k * scatterer.radius, order);
}

std::vector<ExtendedComplex> t_matrix(const Scatterer& scatterer, double k, int order) {
  const auto scaled = scaled_t_matrix(scatterer, k, order);
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

int isolated_order(const Scatterer& scatterer, double k, double tolerance) {
  if (!scatterer.is_disk()) return 0;
  for (int size = oscillating_order(scatterer, k) + 8;; size *= 2) {
    const auto t = t_matrix(scatterer, k, size);
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

}  // namespace flatspeckle
