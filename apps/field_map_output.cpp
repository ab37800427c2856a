#include "apps/field_map_output.h"

#include <algorithm>
#include <cmath>
#include <sstream>

#include "core/error.h"

namespace flatspeckle::apps {

namespace {

constexpr double most_pixels = 100'000;  // of a side

std::string words(const auto& numbers) {
  std::ostringstream text;
  for (std::size_t i = 0; i < numbers.size(); ++i) text << (i > 0 ? " " : "") << numbers[i];
  return text.str();
}

std::size_t pixels_along(const MapSettings& settings, std::size_t side, double extent,
                         double wavelength) {
  constexpr double per_wavelength = 10;
  const double wanted = settings.map_pixels.empty()
                            ? std::max(1.0, std::round(per_wavelength * extent / wavelength))
                            : static_cast<double>(settings.map_pixels[side]);
  if (!(wanted >= 1 && wanted <= most_pixels))
    throw InputError(
        "map_pixels", wanted,
        "must be two whole numbers nx nz from 1 to 100000 (default: ten per wavelength)");
  return static_cast<std::size_t>(wanted);
}

}  // namespace

void add_map_options(Options& options, MapSettings& settings) {
  options.add("--map", settings.map, "x0 x1 z0 z1: the total field on a grid over this rectangle");
  options.add("--map_pixels", settings.map_pixels,
              "nx nz: pixels of the map (default: ten per wavelength)");
}

std::optional<wave::MapGrid> map_grid(const MapSettings& settings, double wavelength) {
  const auto& [map, pixels] = settings;
  if (map.empty()) {
    if (!pixels.empty()) throw InputError("map_pixels", words(pixels), "needs a map");
    return std::nullopt;
  }
  if (map.size() != 4 || !(map[0] < map[1] && map[2] < map[3]) || !std::isfinite(map[1] - map[0]) ||
      !std::isfinite(map[3] - map[2]))
    throw InputError("map", words(map), "must be x0 x1 z0 z1 with x0 < x1 and z0 < z1");
  if (!pixels.empty() && pixels.size() != 2)
    throw InputError("map_pixels", words(pixels), "must be nx nz");
  return wave::MapGrid{{map[0], map[2]},
                       {map[1], map[3]},
                       pixels_along(settings, 0, map[1] - map[0], wavelength),
                       pixels_along(settings, 1, map[3] - map[2], wavelength)};
}

}  // namespace flatspeckle::apps
