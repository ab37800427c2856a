#include "flatland/media/cell_density.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

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

}  // namespace flatspeckle
