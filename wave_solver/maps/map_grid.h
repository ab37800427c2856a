#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "flatland/media/domain.h"

namespace flatspeckle::wave {

/// nx x nz equal pixels that cover a rectangle; a pixel stands for its centre.
struct MapGrid {
  Vec2 low, high;
  std::size_t nx = 0, nz = 0;

  Vec2 step() const {
    return {(high.x - low.x) / static_cast<double>(nx), (high.z - low.z) / static_cast<double>(nz)};
  }
  Vec2 pixel(std::size_t ix, std::size_t iz) const {
    return {low.x + (static_cast<double>(ix) + 0.5) * step().x,
            low.z + (static_cast<double>(iz) + 0.5) * step().z};
  }
};

/// Some rows and columns of a map.
struct MapTile {
  std::size_t ix = 0, iz = 0, nx = 0, nz = 0;

  std::size_t pixels() const { return nx * nz; }
};

/// Tiles are multiples of so many pixels a side, except at the ends of the map.
inline constexpr std::size_t map_chunk = 64;

/// Tiles that make up a map, of about so many pixels each, z-major.
std::vector<MapTile> tiles(const MapGrid& grid, std::size_t pixels);

/// Pixels of a tile, by their place z-major in it, at distances low <= r < high from a point.
std::vector<std::uint32_t> ring_of_pixels(const MapGrid& grid, const MapTile& tile, Vec2 centre,
                                          double low, double high);

}  // namespace flatspeckle::wave
