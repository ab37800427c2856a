#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/numbers/complex.h"
#include "core/result/dataset_row.h"
#include "flatland/media/domain.h"
#include "wave_solver/solutions/wave_solution.h"

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

class RingField;

/// The total field u on a grid: incident and scattered waves outside the scatterers, the
/// transmitted wave in disks of kind tm and te, 0 in soft and hard ones. On a point scatterer,
/// where u is infinite, its own wave is left out: what stands there is the field that excites it. A
/// pixel closer than `on_a_point` wavelengths counts as on it.
///
/// A tile is summed over all scatterers for each pixel or, where that is faster, by a RingField.
///
/// With the basis orders that map_sensors asks for, u is accurate to the solution's tolerance,
/// outside the disks and inside.
class FieldMap {
 public:
  static constexpr double on_a_point = 1e-8;
  enum class Route { fastest, direct };

  /// Keeps a reference to the solution. tolerance: of the fast route, relative to the field.
  FieldMap(const WaveSolution& solution, const MapGrid& grid, double tolerance,
           Route route = Route::fastest);
  ~FieldMap();

  const MapGrid& grid() const { return grid_; }
  /// Tiles in which to ask for the map so that little memory is needed.
  std::vector<MapTile> tiles() const;
  /// [light][z][x]. Threaded.
  std::vector<Complex> field(const MapTile& tile);
  /// How the tiles up to now were summed, in words.
  std::string method() const;

 private:
  struct Points;
  Points place(const MapTile& tile) const;
  std::vector<Complex> outside(const MapTile& tile, const Points& points);
  std::vector<Complex> direct(const std::vector<Vec2>& points) const;
  void correct_near(const MapTile& tile, const Points& points, std::vector<Complex>& field) const;
  void add_incident(const Points& points, std::vector<Complex>& field) const;
  void fill_inside(const MapTile& tile, const Points& points, std::vector<Complex>& field) const;
  bool is_solid(std::size_t scatterer) const;

  const WaveSolution& solution_;
  MapGrid grid_;
  std::unique_ptr<const RingField> rings_;
  std::size_t fast_tiles_ = 0, direct_tiles_ = 0;
};

/// Points near which a map asks for the field, one for each scatterer that it touches: sensors for
/// SolveOptions, so that basis orders resolve the map up to the rims.
std::vector<Vec2> map_sensors(const MapGrid& grid, const Placement& placement);

extern const DatasetTable map_table;

/// Writes total_field [light_angle, map_z, map_x] tile by tile, with progress on standard error,
/// and returns how it was summed. The axis of lights must have been written. Throws Interrupted
/// once a signal has come (catch_interrupts).
std::string write_map(ResultFile& file, const WaveSolution& solution, const MapGrid& grid,
                      double tolerance);

}  // namespace flatspeckle::wave
