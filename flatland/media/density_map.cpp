#include "flatland/media/density_map.h"

#include <algorithm>
#include <cmath>

#include "core/result/result_group.h"

namespace flatspeckle {

DensityMap::DensityMap(Domain box, Material material)
    : MediumProfile({std::move(material)}), box_(box) {}

/// Newton steps, kept within what is known to be too short and too long.
double DensityMap::reach(Vec2 x, Vec2 w, double optical_depth, double longest) const {
  const double mu = bulk().mu_t, wanted = optical_depth / mu;
  double low = 0, high = longest;
  if (!(met(x, w, longest) > wanted)) return longest;
  double at = std::min(wanted / std::max(relative_density(x), 1e-3), high / 2);
  constexpr int most_steps = 100;
  for (int step = 0; step < most_steps && high - low > 1e-13 * longest; ++step) {
    const double missing = wanted - met(x, w, at);
    (missing > 0 ? low : high) = at;
    if (std::abs(missing) < 1e-14 * wanted) break;
    const double next = at + missing / std::max(relative_density(x + at * w), 1e-12);
    at = next > low && next < high ? next : (low + high) / 2;
  }
  return at;
}

BulkMedium DensityMap::mean() const {
  return mean_medium({{&bulk(), mean_relative()}});
}

const DatasetTable density_table{
    "density",
    {{"map_density_x", Data::scale, "", "length", "where the density is told, across"},
     {"map_density_z", Data::scale, "", "length", "where the density is told, deep"},
     {"relative_density", Data::real, "map_density_z map_density_x", "1",
      "density of the scatterers over that which the scene states"}}};

void DensityMap::write(ResultFile& file) const {
  constexpr int cells = 64;
  std::vector<double> x, z, density;
  for (int i = 0; i < cells; ++i) {
    x.push_back(((i + 0.5) / cells - 0.5) * box_.width);
    z.push_back((i + 0.5) / cells * box_.depth);
  }
  for (const double deep : z)
    for (const double across : x) density.push_back(relative_density({across, deep}));
  const ResultGroup root(file, density_table);
  root.put("map_density_x", x);
  root.put("map_density_z", z);
  root.put("relative_density", density);
}

}  // namespace flatspeckle
