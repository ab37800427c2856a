#include "flatland/media/density_map.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "core/result/result_group.h"

namespace flatspeckle {

namespace {

/// Of a coordinate in units of cells; the last cells reach beyond the edges.
std::ptrdiff_t cell_of(double position, std::size_t cells) {
  return std::clamp(static_cast<std::ptrdiff_t>(std::floor(position)), std::ptrdiff_t{0},
                    static_cast<std::ptrdiff_t>(cells) - 1);
}

/// Which cells of one axis a way meets.
struct Steps {
  std::ptrdiff_t cell, step, last;
  double next, between;  ///< distances to the next cell, and from one to another

  Steps(double position, double speed, std::size_t cells)
      : cell(cell_of(position, cells)),
        step(speed > 0 ? 1 : -1),
        last(speed > 0 ? static_cast<std::ptrdiff_t>(cells) - 1 : 0),
        between(1 / std::abs(speed)) {
    const double face = static_cast<double>(cell + (speed > 0 ? 1 : 0));
    next = cell == last || speed == 0 ? std::numeric_limits<double>::infinity()
                                      : (face - position) / speed;
  }

  void advance() {
    cell += step;
    next = cell == last ? std::numeric_limits<double>::infinity() : next + between;
  }
};

}  // namespace

CellDensity::CellDensity(Domain box, Material material, std::size_t rows,
                         std::vector<double> density)
    : DensityMap(box, std::move(material)),
      rows_(rows),
      columns_(density.size() / rows),
      across_(box.width / static_cast<double>(columns_)),
      deep_(box.depth / static_cast<double>(rows)),
      density_(std::move(density)) {}

double CellDensity::relative_density(Vec2 x) const {
  const auto row = static_cast<std::size_t>(cell_of(x.z / deep_, rows_)),
             column =
                 static_cast<std::size_t>(cell_of((x.x + box().width / 2) / across_, columns_));
  return density_[row * columns_ + column];
}

double CellDensity::met(Vec2 x, Vec2 w, double length) const {
  Steps columns((x.x + box().width / 2) / across_, w.x / across_, columns_),
      rows(x.z / deep_, w.z / deep_, rows_);
  double sum = 0, gone = 0;
  while (gone < length) {
    const double to = std::min({columns.next, rows.next, length});
    const auto here =
        static_cast<std::size_t>(rows.cell) * columns_ + static_cast<std::size_t>(columns.cell);
    sum += density_[here] * std::max(0.0, to - gone);
    gone = std::max(gone, to);
    if (to == length) break;
    (columns.next <= rows.next ? columns : rows).advance();
  }
  return sum;
}

double CellDensity::most_relative() const {
  return *std::max_element(density_.begin(), density_.end());
}

double CellDensity::mean_relative() const {
  return std::accumulate(density_.begin(), density_.end(), 0.0) /
         static_cast<double>(density_.size());
}

std::string CellDensity::describe() const {
  return "density of " + std::to_string(rows_) + " x " + std::to_string(columns_) + " cells";
}

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
