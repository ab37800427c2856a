#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "core/numbers/complex.h"

namespace flatspeckle::wave {

/// Sums of all columns, of length n, with random phases, four of them, or the columns themselves
/// where they are fewer: the mean square of what is wrong in the sums is what is wrong in all
/// columns, in sum.
std::vector<Complex> combinations(const std::vector<Complex>& columns, std::size_t n);

/// sqrt(sum w |r|^2 / sum w |b|^2) over all columns b, what is left of them, r, being told by
/// combinations(). weights: [row]
double relative_size(const std::vector<Complex>& combined_r, const std::vector<Complex>& b,
                     const std::vector<double>& weights);

/// a^T b of matrices with n rows, columns by columns: [column of b][column of a].
std::vector<Complex> transposed_product(const std::vector<Complex>& a, const Complex* b,
                                        std::size_t columns_b, std::size_t n);

/// Throws std::runtime_error where a value is infinite or not a number.
void require_finite(std::span<const Complex> values);

}  // namespace flatspeckle::wave
