#pragma once

#include <numeric>
#include <span>
#include <vector>

namespace flatspeckle::grin::design {

using Numbers = std::vector<double>;

inline double dot(const Numbers& a, const Numbers& b) {
  return std::inner_product(a.begin(), a.end(), b.begin(), 0.0);
}
/// a += factor b
inline void add(Numbers& a, double factor, const Numbers& b) {
  for (std::size_t i = 0; i < a.size(); ++i) a[i] += factor * b[i];
}
inline double mean(std::span<const double> a) {
  return std::accumulate(a.begin(), a.end(), 0.0) / static_cast<double>(a.size());
}

}  // namespace flatspeckle::grin::design
