#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

#include "core/numbers/complex.h"

namespace flatspeckle::wave {

/// body(i, j) for i < rows, j < columns, tile by tile: both [i][j] and [j][i] stay in cache.
template <typename Body>
void for_each_tiled(std::size_t rows, std::size_t columns, const Body& body) {
  constexpr std::size_t tile = 32;
  for (std::size_t j0 = 0; j0 < columns; j0 += tile)
    for (std::size_t i0 = 0; i0 < rows; i0 += tile)
      for (std::size_t j = j0; j < std::min(j0 + tile, columns); ++j)
        for (std::size_t i = i0; i < std::min(i0 + tile, rows); ++i) body(i, j);
}

/// Copies the lower triangle of a column-major matrix onto the upper one, tile by tile.
inline void mirror_lower(std::vector<Complex>& matrix, std::size_t size) {
  constexpr std::size_t tile = 32;
  for (std::size_t column0 = 0; column0 < size; column0 += tile)
    for (std::size_t row0 = column0; row0 < size; row0 += tile)
      for (std::size_t row = row0; row < std::min(row0 + tile, size); ++row)
        for (std::size_t column = column0; column < std::min(column0 + tile, row); ++column)
          matrix[row * size + column] = matrix[column * size + row];
}

}  // namespace flatspeckle::wave
