#include "apps/field_map_output.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/error.h"
#include "core/keys/number_text.h"
#include "core/run/interrupt.h"
#include "core/run/progress.h"
#include "core/run/stopwatch.h"

namespace flatspeckle::apps {

namespace {

std::size_t pixels_along(const MapSettings& settings, std::size_t side, double extent,
                         double wavelength) {
  constexpr double per_wavelength = 10, most = 100'000;
  if (!settings.map_pixels.empty()) return static_cast<std::size_t>(settings.map_pixels[side]);
  const double wanted = std::max(1.0, std::round(per_wavelength * extent / wavelength));
  if (wanted > most)
    throw InputError("map", extent, "is too wide for ten pixels per wavelength: give map_pixels");
  return static_cast<std::size_t>(wanted);
}

std::vector<double> pixel_centres(const wave::MapGrid& grid, std::size_t count, bool along_z) {
  std::vector<double> centres;
  for (std::size_t i = 0; i < count; ++i)
    centres.push_back(along_z ? grid.pixel(0, i).z : grid.pixel(i, 0).x);
  return centres;
}

}  // namespace

void add_map_keys(Keys& keys, MapSettings& settings) {
  keys.group("Map");
  keys.add("map", settings.map, "x0 x1 z0 z1: the total field on a grid over this rectangle")
      .exactly(4, "x0 x1 z0 z1 with x0 < x1 and z0 < z1")
      .unit("length");
  keys.add("map_pixels", settings.map_pixels,
           "nx nz: pixels of the map (default: ten per wavelength)")
      .exactly(2, "two whole numbers nx nz from 1 to 100000")
      .from(1, 100'000)
      .only_of("a map");
}

std::optional<wave::MapGrid> map_grid(const Keys& keys, const MapSettings& settings,
                                      double wavelength) {
  const auto& map = keys.read(settings.map);
  if (map.empty()) return std::nullopt;
  if (!(map[0] < map[1] && map[2] < map[3]) || !std::isfinite(map[1] - map[0]) ||
      !std::isfinite(map[3] - map[2]))
    throw InputError("map", number_text(map), "must be x0 x1 z0 z1 with x0 < x1 and z0 < z1");
  keys.read(settings.map_pixels);
  return wave::MapGrid{{map[0], map[2]},
                       {map[1], map[3]},
                       pixels_along(settings, 0, map[1] - map[0], wavelength),
                       pixels_along(settings, 1, map[3] - map[2], wavelength)};
}

std::optional<std::string> write_map(ResultFile& file, const wave::WaveSolution& solution,
                                     const wave::MapGrid& grid, double tolerance) {
  wave::FieldMap map(solution, grid, tolerance);
  file.scale("map_z", pixel_centres(grid, grid.nz, true), "length", "depth of the pixels");
  file.scale("map_x", pixel_centres(grid, grid.nx, false), "length",
             "transverse place of the pixels");
  file.begin_dataset("total_field", {"light_angle", "map_z", "map_x"},
                     {1, wave::map_chunk, wave::map_chunk}, "1",
                     "incident and scattered field, also inside; 0 in soft and hard disks; on a "
                     "point scatterer the field that excites it");
  file.attribute("total_field", "wavelength", 2 * std::numbers::pi / solution.system().k());
  const double all = static_cast<double>(grid.nx) * static_cast<double>(grid.nz);
  Progress progress("map", "pixels");
  const Stopwatch clock;
  Progress::Figures figures;
  for (const wave::MapTile& tile : map.tiles()) {
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

}  // namespace flatspeckle::apps
