#include "core/search/measured.h"

#include <cmath>
#include <limits>
#include <numbers>

#include "core/contract.h"

namespace flatspeckle {

namespace {

Measured combined(const Measured& a, const Measured& b, auto&& of) {
  FS_EXPECT(a.without.size() == b.without.size());
  Measured made{of(a.value, b.value)};
  for (std::size_t i = 0; i < a.without.size(); ++i)
    made.without.push_back(of(a.without[i], b.without[i]));
  return made;
}

}  // namespace

double error(const Measured& one) {
  const auto blocks = static_cast<double>(one.without.size());
  if (one.without.empty()) return 0;
  if (one.without.size() == 1) return std::numeric_limits<double>::infinity();
  double mean = 0, square = 0;
  for (const double value : one.without) mean += value / blocks;
  for (const double value : one.without) square += (value - mean) * (value - mean);
  return std::sqrt(square * (blocks - 1) / blocks);
}

double Difference::significance() const {
  return value == 0 ? 0 : value / error;
}

double Difference::confidence() const {
  return std::erfc(-significance() / std::numbers::sqrt2) / 2;
}

Difference difference(const Measured& a, const Measured& b) {
  const Measured made = combined(a, b, [](double x, double y) { return x - y; });
  return {made.value, error(made)};
}

Measured ratio(const Measured& a, const Measured& b) {
  return combined(a, b, [](double x, double y) { return x / y; });
}

}  // namespace flatspeckle
