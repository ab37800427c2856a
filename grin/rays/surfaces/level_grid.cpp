#include "grin/rays/surfaces/level_grid.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "core/error.h"

namespace flatspeckle::grin {

LevelGrid::LevelGrid(const Vec3& origin, double spacing, const std::array<int, 3>& nodes,
                     std::vector<double> coefficients)
    : f_(SplineField::of_coefficients({origin + Vec3::Constant(spacing),
                                       Vec3::Constant(spacing),
                                       {nodes[0] - 2, nodes[1] - 2, nodes[2] - 2}},
                                      std::move(coefficients))),
      spacing_(spacing),
      cells_{nodes[0] - 3, nodes[1] - 3, nodes[2] - 3} {
  find_zeros();
  add_up();
  for (int axis = 0; axis < 3; ++axis) spread_along(axis);
}

SplineCell LevelGrid::cell(const Cell& c) const {
  const auto& extent = f_.extent();
  SplineCell cell;
  for (int row = 0; row < 16; ++row) {
    const std::size_t line = static_cast<std::size_t>(c[0] + row / 4) * extent[1] + c[1] + row % 4;
    cell.rows[row] =
        Eigen::Map<const SplineCell::Four>(&f_.coefficients()[line * extent[2] + c[2]]);
  }
  return cell;
}

template <class Use>
void LevelGrid::for_each_cell(const Use& use) const {
  for (int i = 0; i < cells_[0]; ++i)
    for (int j = 0; j < cells_[1]; ++j)
      for (int k = 0; k < cells_[2]; ++k) use(Cell{i, j, k});
}

void LevelGrid::find_zeros() {
  const double slack = 1e-6 * spacing_;
  double squared = spacing_ * spacing_;
  Cell low = cells_, high{0, 0, 0};
  clear_.assign(number({cells_[0], 0, 0}), std::numeric_limits<std::uint8_t>::max());
  for_each_cell([&](const Cell& c) {
    const SplineCell spline = cell(c);
    squared = std::max(squared, spline.most_squared_slope());
    if (!spline.touches_zero(slack) || !spline.bezier().touches_zero(slack)) return;
    clear_[number(c)] = 0;
    for (int a = 0; a < 3; ++a) {
      low[a] = std::min(low[a], c[a]);
      high[a] = std::max(high[a], c[a] + 1);
    }
  });
  if (high[0] == 0) throw InputError("nothing would be inside of the surface");
  steepest_ = std::sqrt(squared) / spacing_;
  const Vec3& origin = f_.grid().origin;
  bounds_ = {origin + spacing_ * Vec3(low[0], low[1], low[2]),
             origin + spacing_ * Vec3(high[0], high[1], high[2])};
  rounding_ =
      4e-16 * (4 * spacing_ + bounds_.low.cwiseAbs().cwiseMax(bounds_.high.cwiseAbs()).maxCoeff());
}

void LevelGrid::add_up() {
  double cells = 0;
  for_each_cell([&](const Cell& c) {
    const SplineCell spline = cell(c);
    if (clearance(c) == 0)
      cells += spline.negative_share();
    else if (spline.bezier().rows[0][0] < 0)
      cells += 1;
  });
  volume_ = cells * spacing_ * spacing_ * spacing_;
}

/// Of each cell how far along the axis one is that is no further away along the axes before it.
void LevelGrid::spread_along(int axis) {
  const std::array<std::size_t, 3> stride{number({1, 0, 0}), number({0, 1, 0}), 1};
  const int count = cells_[axis];
  std::vector<int> line(count);
  for (std::size_t base = 0; base < clear_.size(); ++base) {
    if (base / stride[axis] % count != 0) continue;
    for (int i = 0; i < count; ++i) line[i] = clear_[base + i * stride[axis]];
    for (int i = 0; i < count; ++i) {
      int best = line[i];
      for (int away = 1; away < best; ++away) {
        if (i >= away) best = std::min(best, std::max(away, line[i - away]));
        if (i + away < count) best = std::min(best, std::max(away, line[i + away]));
      }
      clear_[base + i * stride[axis]] = static_cast<std::uint8_t>(best);
    }
  }
}

}  // namespace flatspeckle::grin
