#include "grin/rays/surfaces/level_surface.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

#include "core/error.h"
#include "grin/media/fields/spline_field.h"
#include "grin/rays/surfaces/spline_cell.h"
#include "grin/rays/surfaces/straight_way.h"

namespace flatspeckle::grin {

/// A sum of cubic B-splines on a grid of cubes, and in which of its cells it may be 0.
class LevelGrid {
 public:
  using Cell = std::array<int, 3>;

  /// As LevelSurface.
  LevelGrid(const Vec3& origin, double spacing, const std::array<int, 3>& nodes,
            std::vector<double> coefficients);

  const SplineField& f() const { return f_; }
  double spacing() const { return spacing_; }
  double steepest() const { return steepest_; }  ///< |gradient of f| is nowhere more
  double rounding() const { return rounding_; }  ///< of f
  double volume() const { return volume_; }      ///< where f is negative
  /// Around the cells where f may be 0.
  const Box& bounds() const { return bounds_; }

  /// In units of cells, from the low corner of the first one.
  Vec3 place(const Vec3& x) const { return (x - f_.grid().origin) / spacing_; }
  bool has(const Cell& c) const {
    for (int a = 0; a < 3; ++a)
      if (c[a] < 0 || c[a] >= cells_[a]) return false;
    return true;
  }
  /// How many cells away, along any axis, is one where f may be 0.
  int clearance(const Cell& c) const { return clear_[number(c)]; }
  /// No more than the distance of a place in the grid from where f is 0.
  double clear_way(const Vec3& x) const {
    const Vec3 at = place(x).array().floor();
    const Cell c{static_cast<int>(at[0]), static_cast<int>(at[1]), static_cast<int>(at[2])};
    return has(c) ? spacing_ * std::max(clearance(c) - 1, 0) : 0;
  }
  SplineCell cell(const Cell& c) const;

 private:
  std::size_t number(const Cell& c) const {
    return (static_cast<std::size_t>(c[0]) * cells_[1] + c[1]) * cells_[2] + c[2];
  }
  template <class Use>
  void for_each_cell(const Use& use) const;
  void find_zeros();
  void add_up();
  void spread_along(int axis);

  SplineField f_;
  double spacing_;
  std::array<int, 3> cells_;
  std::vector<std::uint8_t> clear_;
  double steepest_ = 1, rounding_ = 0;
  double volume_ = 0;
  Box bounds_;
};

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

namespace {

/// A line through the cells of a grid where f may be 0, and from one of these to the next.
class LevelLine {
 public:
  /// side: the sign of f at the start.
  LevelLine(const LevelGrid& grid, const Vec3& x, const Vec3& d, double side)
      : grid_(grid),
        from_(grid.place(x)),
        speed_(d / grid.spacing()),
        per_cell_(speed_.cwiseInverse()),
        side_(side) {}

  /// From `start` on; nothing where the grid ends before.
  std::optional<double> first_change(double start) {
    at_ = start;
    for (int a = 0; a < 3; ++a) cell_[a] = cell_at(a);
    while (grid_.has(cell_)) {
      const int clearance = grid_.clearance(cell_);
      const Leaving leaving = way_out_of(std::max(clearance - 1, 0));
      if (clearance == 0 && leaving.way - at_ > shortest * grid_.spacing())
        if (const auto way = change_before(leaving.way)) return way;
      go_on(leaving);
    }
    return std::nullopt;
  }

 private:
  static constexpr double shortest = 1e-12;  // in cells; less is left to the next one

  int cell_at(int axis) const {
    return static_cast<int>(std::floor(from_[axis] + at_ * speed_[axis]));
  }

  /// The end of the cells that are no further from this one.
  struct Leaving {
    double way;
    int axis, wide;
  };
  Leaving way_out_of(int wide) const {
    Leaving leaving{no_way, 0, wide};
    for (int a = 0; a < 3; ++a) {
      if (speed_[a] == 0) continue;
      const double way =
          ((speed_[a] > 0 ? cell_[a] + wide + 1 : cell_[a] - wide) - from_[a]) * per_cell_[a];
      if (way < leaving.way) leaving = {way, a, wide};
    }
    return leaving;
  }
  void go_on(const Leaving& leaving) {
    at_ = std::max(at_, leaving.way);
    for (int a = 0; a < 3; ++a) {
      if (a == leaving.axis)
        cell_[a] += speed_[a] > 0 ? leaving.wide + 1 : -leaving.wide - 1;
      else
        cell_[a] = std::clamp(cell_at(a), cell_[a] - leaving.wide, cell_[a] + leaving.wide);
    }
  }

  /// Within this cell. The zero that a line starts on is divided out.
  std::optional<double> change_before(double end) {
    const Vec3 corner(cell_[0], cell_[1], cell_[2]);
    auto f = grid_.cell(cell_).along(from_ + at_ * speed_ - corner, from_ + end * speed_ - corner);
    if (!level_) level_ = std::min(0.0, side_ * f.c[0]);
    for (double& c : f.c) c = side_ * c - *level_;
    const double rounding = grid_.rounding();
    if (f.c[0] < -rounding) return at_;
    const bool starts_on_zero = f.c[0] <= rounding && f.c[1] > f.c[0];
    const auto zero = starts_on_zero ? f.without_zero_at_start().first_zero(10 * rounding)
                                     : f.first_zero(2 * rounding);
    return zero ? std::optional(at_ + *zero * (end - at_)) : std::nullopt;
  }

  const LevelGrid& grid_;
  Vec3 from_, speed_, per_cell_;  ///< in cells, and lengths for one along each axis
  double side_, at_ = 0;
  LevelGrid::Cell cell_ = {};
  std::optional<double> level_ = {};  ///< of side f; 0, or that of a start beyond it
};

/// As LevelSurface::way.
double way_to_level(const LevelGrid& grid, const Vec3& x, const Vec3& d, double side) {
  const Box& bounds = grid.bounds();
  const double start = bounds.distance(x) > 0 ? way_in(bounds, x, d) : 0;
  const auto way = start < no_way ? LevelLine(grid, x, d, side).first_change(start) : std::nullopt;
  if (way) return *way;
  return side > 0 || start > 0 ? no_way : way_out(bounds, x, d);
}

std::vector<Vec3> places_inside(const LevelGrid& grid) {
  constexpr int across = 6;
  const Box& box = grid.bounds();
  std::vector<Vec3> places;
  for (int i = 0; i < across * across * across; ++i) {
    const Vec3 cell(i % across, i / across % across, i / across / across);
    const Vec3 share = (cell.array() + 0.5) / across;
    const Vec3 x = box.low + (box.high - box.low).cwiseProduct(share);
    if (grid.f().excess(x) < 0) places.push_back(x);
  }
  return places;
}

bool seems_convex(const LevelGrid& grid) {
  const std::vector<Vec3> inside = places_inside(grid);
  for (std::size_t i = 0; i < inside.size(); ++i)
    for (std::size_t j = 0; j < i; ++j)
      if (grid.f().excess((inside[i] + inside[j]) / 2) > 0) return false;
  return true;
}

}  // namespace

LevelSurface::LevelSurface(const Vec3& origin, double spacing, const std::array<int, 3>& nodes,
                           std::vector<double> coefficients, double meant_volume)
    : grid_(std::make_shared<const LevelGrid>(origin, spacing, nodes, std::move(coefficients))),
      meant_volume_(meant_volume),
      looks_convex_(seems_convex(*grid_)) {}

double LevelSurface::distance(const Vec3& x) const {
  const double beyond = bounds().distance(x);
  if (beyond >= spacing()) return beyond;
  const double f = grid_->f().excess(x), least = std::max(beyond, grid_->clear_way(x));
  return std::copysign(std::max(std::abs(f) / grid_->steepest(), least), f);
}

Vec3 LevelSurface::normal(const Vec3& x) const {
  return grid_->f().gradient(x).gradient.normalized();
}

Mat3 LevelSurface::curvature(const Vec3& x) const {
  const IndexHessian jet = grid_->f().hessian(x);
  const double slope = jet.gradient.norm();
  const Vec3 n = jet.gradient / slope;
  return (jet.hessian - n * (n.transpose() * jet.hessian)) / slope;
}

double LevelSurface::way(const Vec3& x, const Vec3& d, double sign) const {
  return way_to_level(*grid_, x, d, sign);
}

const Box& LevelSurface::bounds() const {
  return grid_->bounds();
}
double LevelSurface::spacing() const {
  return grid_->spacing();
}
double LevelSurface::volume() const {
  return grid_->volume();
}

}  // namespace flatspeckle::grin
