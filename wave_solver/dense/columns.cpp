#include "wave_solver/dense/columns.h"

#include <cmath>
#include <numbers>
#include <stdexcept>

#include "core/numbers/random.h"
#include "wave_solver/dense/blas.h"

namespace flatspeckle::wave {

namespace {

double weighted_square(const std::vector<double>& weights, const std::vector<Complex>& columns) {
  double sum = 0;
  for (std::size_t start = 0; start < columns.size(); start += weights.size())
    for (std::size_t i = 0; i < weights.size(); ++i)
      sum += weights[i] * std::norm(columns[start + i]);
  return sum;
}

}  // namespace

std::vector<Complex> combinations(const std::vector<Complex>& columns, std::size_t n) {
  constexpr std::size_t sums = 4;
  if (n == 0 || columns.size() <= sums * n) return columns;
  const std::size_t count = columns.size() / n;
  RandomStream random(0, 0, 0);
  std::vector<Complex> phases(count * sums), combined(n * sums);
  for (Complex& phase : phases) phase = std::polar(1.0, 2 * std::numbers::pi * random.uniform());
  multiply(CblasNoTrans, CblasNoTrans, n, sums, count, 1, columns.data(), n, phases.data(), count,
           0, combined.data(), n);
  return combined;
}

double relative_size(const std::vector<Complex>& combined_r, const std::vector<Complex>& b,
                     const std::vector<double>& weights) {
  const double given = weighted_square(weights, b);
  if (!(given > 0)) return 0;
  const bool all = combined_r.size() == b.size();
  const double sums = all ? 1 : static_cast<double>(combined_r.size() / weights.size());
  return std::sqrt(weighted_square(weights, combined_r) / sums / given);
}

void require_finite(std::span<const Complex> values) {
  for (const Complex& value : values)
    if (!std::isfinite(value.real()) || !std::isfinite(value.imag()))
      throw std::runtime_error("the multiple-scattering equations have no finite solution");
}

std::vector<Complex> transposed_product(const std::vector<Complex>& a, const Complex* b,
                                        std::size_t columns_b, std::size_t n) {
  if (n == 0) return {};
  const std::size_t columns_a = a.size() / n;
  std::vector<Complex> result(columns_b * columns_a);
  if (result.empty()) return result;
  multiply(CblasTrans, CblasNoTrans, columns_a, columns_b, n, 1, a.data(), n, b, n, 0,
           result.data(), columns_a);
  return result;
}

}  // namespace flatspeckle::wave
