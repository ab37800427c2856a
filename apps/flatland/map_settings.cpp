#include "apps/flatland/map_settings.h"

#include <algorithm>
#include <cmath>

#include "core/error.h"
#include "core/keys/number_text.h"

namespace flatspeckle::apps {

namespace {

std::size_t pixels_along(const MapSettings& settings, std::size_t side, double extent,
                         double wavelength) {
  constexpr double per_wavelength = 10, most = 100'000;
  if (!settings.map_pixels.empty()) return static_cast<std::size_t>(settings.map_pixels[side]);
  const double wanted = std::max(1.0, std::round(per_wavelength * extent / wavelength));
  if (wanted > most)
    throw InputError("map", extent,
                     "is too wide for the default of ten pixels per wavelength: give map_pixels");
  return static_cast<std::size_t>(wanted);
}

}  // namespace

void add_map_keys(Keys& keys, MapSettings& settings) {
  keys.group("Map");
  keys.add("map", settings.map,
           "Also write a map of the total field over the rectangle x0 x1 z0 z1")
      .exactly(4, "x0 x1 z0 z1 with x0 < x1 and z0 < z1")
      .unit("length");
  keys.add("map_pixels", settings.map_pixels,
           "Numbers of pixels of the map, nx nz (default: ten pixels per wavelength)")
      .exactly(2, "two whole numbers nx nz from 1 to 100000")
      .from(1, 100'000)
      .only_of("a map");
  keys.add("map_y", settings.map_y, "y of the plane of the map (default 0)")
      .unit("length")
      .only_of("maps with dimension = 3");
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

}  // namespace flatspeckle::apps
