#pragma once

#include <cstring>

namespace flatspeckle {

/// Four numbers that compilers work on at once: in one register where there are such wide ones.
using WideFour = double __attribute__((vector_size(32), may_alias));

inline const WideFour& wide_four_at(const double* aligned) {
  return *reinterpret_cast<const WideFour*>(aligned);
}
inline WideFour& wide_four_at(double* aligned) {
  return *reinterpret_cast<WideFour*>(aligned);
}
/// Any four that follow each other, wherever they begin.
inline void load(const double* first, WideFour& four) { std::memcpy(&four, first, sizeof four); }

/// Of a matrix of four rows: eight shuffles, which a compiler does not find by itself.
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
