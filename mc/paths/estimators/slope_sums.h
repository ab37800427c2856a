#pragma once

#include <algorithm>
#include <span>
#include <vector>

#include "core/numbers/complex.h"
#include "flatland/request/request.h"

namespace flatspeckle::mc {

/// Fields of a path with their derivatives by some parameters, and the sums of
/// weight f_a conj(f_b) and its derivatives, [1 + parameter][entry].
class SlopeSums {
 public:
  /// entries: pairs of so many fields.
  SlopeSums(std::size_t fields, std::span<const Entry> entries, std::size_t parameters,
            std::span<Complex> sums)
      : entries_(entries),
        parameters_(parameters),
        sums_(sums),
        field_(fields),
        field_slope_(field_.size() * parameters) {}

  void clear() {
    std::fill(field_.begin(), field_.end(), 0);
    std::fill(field_slope_.begin(), field_slope_.end(), 0);
  }

  /// A term of a field; slope(p): its logarithmic derivative by parameter p.
  template <typename Slope>
  void add_term(std::size_t c, Complex term, const Slope& slope) {
    field_[c] += term;
    for (std::size_t p = 0; p < parameters_; ++p)
      field_slope_[p * field_.size() + c] += product(term, slope(p));
  }

  void accumulate(double weight) {
    const std::size_t entries = entries_.size();
    for (std::size_t e = 0; e < entries; ++e) {
      const auto [a, b] = entries_[e];
      sums_[e] += weight * product_with_conjugate(field_[a], field_[b]);
      for (std::size_t p = 0; p < parameters_; ++p) {
        const Complex* slope = &field_slope_[p * field_.size()];
        sums_[(1 + p) * entries + e] += weight * (product_with_conjugate(slope[a], field_[b]) +
                                                  product_with_conjugate(field_[a], slope[b]));
      }
    }
  }

 private:
  std::span<const Entry> entries_;
  std::size_t parameters_;
  std::span<Complex> sums_;
  std::vector<Complex> field_;        ///< of each
  std::vector<Complex> field_slope_;  ///< its derivatives, [parameter][field]
};

}  // namespace flatspeckle::mc
