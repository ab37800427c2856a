#include "wave_solver/maps/map_grid.h"

#include <algorithm>
#include <cmath>

namespace flatspeckle::wave {

namespace {

// Pixels of one axis whose centres may lie within `distance` of `place`: first and one past last.
struct Range {
  Range(double low, double step, double place, double distance, std::size_t from,
        std::size_t count) {
    const auto limit = [&](double at) {
      return static_cast<std::size_t>(
          std::clamp(at, static_cast<double>(from), static_cast<double>(from + count)));
    };
    const double middle = (place - low) / step - 0.5, reach = distance / step;
    first = limit(std::floor(middle - reach));
    last = limit(std::ceil(middle + reach) + 1);
  }
  std::size_t first, last;
};

std::size_t whole_chunks(std::size_t wanted, std::size_t most) {
  return std::min(std::max<std::size_t>(wanted / map_chunk, 1) * map_chunk, most);
}

}  // namespace

std::vector<MapTile> tiles(const MapGrid& grid, std::size_t pixels) {
  const std::size_t nx = whole_chunks(pixels / map_chunk, grid.nx);
  const std::size_t nz = whole_chunks(pixels / nx, grid.nz);
  std::vector<MapTile> all;
  for (std::size_t iz = 0; iz < grid.nz; iz += nz)
    for (std::size_t ix = 0; ix < grid.nx; ix += nx)
      all.push_back({ix, iz, std::min(nx, grid.nx - ix), std::min(nz, grid.nz - iz)});
  return all;
}

std::vector<std::uint32_t> ring_of_pixels(const MapGrid& grid, const MapTile& tile, Vec2 centre,
                                          double low, double high) {
  const Range across(grid.low.x, grid.step().x, centre.x, high, tile.ix, tile.nx);
  const Range along(grid.low.z, grid.step().z, centre.z, high, tile.iz, tile.nz);
  std::vector<std::uint32_t> found;
  for (std::size_t iz = along.first; iz < along.last; ++iz)
    for (std::size_t ix = across.first; ix < across.last; ++ix) {
      const double r = length(grid.pixel(ix, iz) - centre);
      if (low <= r && r < high)
        found.push_back(static_cast<std::uint32_t>((iz - tile.iz) * tile.nx + ix - tile.ix));
    }
  return found;
}

}  // namespace flatspeckle::wave
