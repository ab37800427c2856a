#include "wave_solver/maps/map_datasets.h"

#include <numbers>

#include "core/result/result_group.h"
#include "core/run/interrupt.h"
#include "core/run/progress.h"
#include "core/run/stopwatch.h"

namespace flatspeckle::wave {

const DatasetTable map_table{
    .name = "map",
    .rows = {{"map_z", Data::scale, "", "length", "depth of the pixels"},
             {"map_x", Data::scale, "", "length", "transverse place of the pixels"},
             {"total_field", Data::complex, "light_angle map_z map_x", "1",
              "incident and scattered field, also inside; 0 in soft and hard disks; on a point "
              "scatterer the field that excites it"}},
    .attributes = {{"total_field", "wavelength", "float64", "in vacuum"}}};

namespace {

std::vector<double> pixel_centres(const MapGrid& grid, std::size_t count, bool along_z) {
  std::vector<double> centres;
  for (std::size_t i = 0; i < count; ++i)
    centres.push_back(along_z ? grid.pixel(0, i).z : grid.pixel(i, 0).x);
  return centres;
}

}  // namespace

std::optional<std::string> write_map(ResultFile& file, const WaveSolution& solution,
                                     const MapGrid& grid, double tolerance) {
  FieldMap map(solution, grid, tolerance);
  const ResultGroup root(file, map_table);
  root.put("map_z", pixel_centres(grid, grid.nz, true));
  root.put("map_x", pixel_centres(grid, grid.nx, false));
  root.begin("total_field", {1, map_chunk, map_chunk});
  root.attribute("total_field", "wavelength", 2 * std::numbers::pi / solution.system().k());
  const double all = static_cast<double>(grid.nx) * static_cast<double>(grid.nz);
  Progress progress("map", "pixels");
  const Stopwatch clock;
  Progress::Figures figures;
  for (const MapTile& tile : map.tiles()) {
    file.write_block("total_field", map.field(tile), {0, tile.iz, tile.ix},
                     {solution.light_angles().size(), tile.nz, tile.nx});
    if (interrupted()) return std::nullopt;
    const double wall = clock.seconds();
    figures.samples += static_cast<double>(tile.pixels());
    figures.rate = figures.samples / wall;
    figures.seconds_left = (all - figures.samples) / figures.rate;
    progress.update(wall, figures);
  }
  progress.finish(clock.seconds(), figures);
  return map.method();
}

}  // namespace flatspeckle::wave
