#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

#include "core/numbers/complex.h"

namespace flatspeckle::wave {

inline constexpr std::size_t tile = 32;

/// body(i, j) for i < rows, j < columns, tile by tile: both [i][j] and [j][i] stay in cache.
template <typename Body>
void for_each_tiled(std::size_t rows, std::size_t columns, const Body& body) {
  for (std::size_t j0 = 0; j0 < columns; j0 += tile)
    for (std::size_t i0 = 0; i0 < rows; i0 += tile)
      for (std::size_t j = j0; j < std::min(j0 + tile, columns); ++j)
        for (std::size_t i = i0; i < std::min(i0 + tile, rows); ++i) body(i, j);
}

/// Copies columns begin .. end - 1 of the lower triangle of a column-major matrix onto the upper
/// one, tile by tile.
inline void mirror_columns(Complex* matrix, std::size_t size, std::size_t begin, std::size_t end) {
  for (std::size_t row0 = begin; row0 < size; row0 += tile)
    for (std::size_t row = row0; row < std::min(row0 + tile, size); ++row)
      for (std::size_t column = begin; column < std::min(end, row); ++column)
        matrix[row * size + column] = matrix[column * size + row];
}

inline void mirror_lower(std::vector<Complex>& matrix, std::size_t size) {
  for (std::size_t column = 0; column < size; column += tile)
    mirror_columns(matrix.data(), size, column, std::min(column + tile, size));
}

}  // namespace flatspeckle::wave
