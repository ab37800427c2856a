#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/numbers/complex.h"
#include "core/result/dataset_row.h"
#include "flatland/media/domain.h"
#include "wave_solver/solutions/wave_solution.h"

namespace flatspeckle::wave {

/// Grid of nx x nz equal pixels that cover a rectangle. Fields are evaluated at pixel centres.
struct MapGrid {
  Vec low, high;
  std::size_t nx = 0, nz = 0;

  Vec step() const {
    return {(high.x - low.x) / static_cast<double>(nx), (high.z - low.z) / static_cast<double>(nz)};
  }
  Vec pixel(std::size_t ix, std::size_t iz) const {
    return {low.x + (static_cast<double>(ix) + 0.5) * step().x,
            low.z + (static_cast<double>(iz) + 0.5) * step().z};
  }
};

/// Rectangular part of a map: nx x nz pixels, the first of which is (ix, iz).
struct MapTile {
  std::size_t ix = 0, iz = 0, nx = 0, nz = 0;

  std::size_t pixels() const { return nx * nz; }
};

/// Sides of tiles are multiples of this number of pixels, except at the edges of the map.
inline constexpr std::size_t map_chunk = 64;

/// Divides a map into tiles of about the given number of pixels each, in z-major order.
std::vector<MapTile> tiles(const MapGrid& grid, std::size_t pixels);

/// Returns the indices (z-major within the tile) of the pixels whose distance r from a point is low
/// <= r < high.
std::vector<std::uint32_t> ring_of_pixels(const MapGrid& grid, const MapTile& tile, Vec centre,
                                          double low, double high);

class RingField;

/// A plane wave amplitude e^{i k w.(r - origin)}.
struct PlaneWave {
  WaveDirection w;
  Complex amplitude;
  Vec origin;
};

/// Solved equations whose field is mapped. The incident field of each light is a sum of plane
/// waves.
struct MappedSolution {
  const TMatrixSystem* system;
  std::vector<std::vector<PlaneWave>> lights;
  std::span<const Complex> coefficients;  ///< beta, [light][unknown]
};
/// Refers to the solution.
MappedSolution mapped(const WaveSolution& solution);

/// The total field u on a grid: incident and scattered waves outside the scatterers, the
/// transmitted wave in disks of kind tm and te, 0 in soft and hard disks. At a point scatterer u is
/// infinite; there the map contains the field that excites the scatterer, without the wave that it
/// scatters. A pixel closer than `on_a_point` wavelengths to a point scatterer counts as being at
/// it.
///
/// The field of a tile is summed directly over all scatterers for each pixel or, if that is faster,
/// by FFT over point sources that replace the scatterers (RingField).
///
/// If the solution was computed with map_sensors() as SolveOptions::sensors, u is accurate to the
/// tolerance of the solution outside and inside the disks.
class FieldMap {
 public:
  static constexpr double on_a_point = 1e-8;
  enum class Route { fastest, direct };

  /// Refers to the equations and coefficients of the solution. tolerance: error of the sum by FFT,
  /// relative to the field.
  FieldMap(MappedSolution solution, const MapGrid& grid, double tolerance,
           Route route = Route::fastest);
  FieldMap(const WaveSolution& solution, const MapGrid& grid, double tolerance,
           Route route = Route::fastest)
      : FieldMap(mapped(solution), grid, tolerance, route) {}
  ~FieldMap();

  const MapGrid& grid() const { return grid_; }
  /// Returns tiles small enough for field() to need little memory.
  std::vector<MapTile> tiles() const;
  /// Returns the total field, [light][z][x]. Threaded.
  std::vector<Complex> field(const MapTile& tile);
  /// Describes how many of the tiles computed so far were summed directly and by FFT.
  std::string method() const;

 private:
  struct Points;
  Points place(const MapTile& tile) const;
  std::vector<Complex> outside(const MapTile& tile, const Points& points);
  std::vector<Complex> direct(const std::vector<Vec>& points) const;
  void correct_near(const MapTile& tile, const Points& points, std::vector<Complex>& field) const;
  void add_incident(const Points& points, std::vector<Complex>& field) const;
  void fill_inside(const MapTile& tile, const Points& points, std::vector<Complex>& field) const;
  bool is_solid(std::size_t scatterer) const;

  const TMatrixSystem& system() const { return *solution_.system; }

  MappedSolution solution_;
  MapGrid grid_;
  std::unique_ptr<const RingField> rings_;
  std::size_t fast_tiles_ = 0, direct_tiles_ = 0;
};

/// Returns, for each disk, the point of the map that is nearest to it, or a point on its rim if the
/// map touches the disk. With these points as SolveOptions::sensors, the basis orders are high
/// enough for the whole map, up to the rims.
std::vector<Vec> map_sensors(const MapGrid& grid, const Placement& placement);

extern const DatasetTable map_table;

/// Writes total_field [light, map_z, map_x] tile by tile, with progress on standard error. field:
/// returns the field of a tile, [light][z][x]. The axis of lights must have been written. Throws
/// Interrupted after a signal (catch_interrupts).
void write_tiles(ResultFile& file, const MapGrid& grid, double k, std::size_t lights,
                 const std::vector<MapTile>& tiles,
                 const std::function<std::vector<Complex>(const MapTile&)>& field);

/// Writes total_field [light, map_z, map_x] tile by tile, with progress on standard error, and
/// returns FieldMap::method(). The axis of lights must have been written. Throws Interrupted after
/// a signal (catch_interrupts).
std::string write_map(ResultFile& file, const MappedSolution& solution, const MapGrid& grid,
                      double tolerance);

}  // namespace flatspeckle::wave
