#pragma once

#include <cstring>

namespace flatspeckle {

/// Four doubles that are processed at once, in one register if the processor has 256-bit registers.
using WideFour = double __attribute__((vector_size(32), may_alias));

inline const WideFour& wide_four_at(const double* aligned) {
  return *reinterpret_cast<const WideFour*>(aligned);
}
inline WideFour& wide_four_at(double* aligned) {
  return *reinterpret_cast<WideFour*>(aligned);
}
/// Loads four consecutive numbers of any alignment.
inline void load(const double* first, WideFour& four) {
  std::memcpy(&four, first, sizeof four);
}

/// Transposes a 4 x 4 matrix, given as four rows, by eight shuffles, a sequence that compilers do
/// not find by themselves.
[[gnu::always_inline]] inline void transpose(WideFour* rows) {
  const WideFour even_01 = __builtin_shufflevector(rows[0], rows[1], 0, 4, 2, 6);
  const WideFour odd_01 = __builtin_shufflevector(rows[0], rows[1], 1, 5, 3, 7);
  const WideFour even_23 = __builtin_shufflevector(rows[2], rows[3], 0, 4, 2, 6);
  const WideFour odd_23 = __builtin_shufflevector(rows[2], rows[3], 1, 5, 3, 7);
  rows[0] = __builtin_shufflevector(even_01, even_23, 0, 1, 4, 5);
  rows[1] = __builtin_shufflevector(odd_01, odd_23, 0, 1, 4, 5);
  rows[2] = __builtin_shufflevector(even_01, even_23, 2, 3, 6, 7);
  rows[3] = __builtin_shufflevector(odd_01, odd_23, 2, 3, 6, 7);
}

}  // namespace flatspeckle
