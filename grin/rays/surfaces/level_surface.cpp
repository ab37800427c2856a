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
#include "grin/rays/surfaces/straight_crossing.h"

namespace flatspeckle::grin {

/// A sum f of cubic B-splines on a grid of cubes, and the cells in which f may be 0.
class LevelGrid {
 public:
  using Cell = std::array<int, 3>;

  /// Takes the same arguments as the constructor of LevelSurface.
  LevelGrid(const Vec3& origin, double spacing, const std::array<int, 3>& nodes,
            std::vector<double> coefficients);

  const SplineField& f() const { return f_; }
  double spacing() const { return spacing_; }
  double steepest() const { return steepest_; }  ///< upper bound of |gradient of f|
  double rounding() const { return rounding_; }  ///< rounding error of f
  double volume() const { return volume_; }      ///< volume where f is negative
  /// Bounding box of the cells where f may be 0.
  const Box& bounds() const { return bounds_; }

  /// Converts x to a position in units of cells, relative to the low corner of the first cell.
  Vec3 place(const Vec3& x) const { return (x - f_.grid().origin) / spacing_; }
  bool has(const Cell& c) const {
    for (int a = 0; a < 3; ++a)
      if (c[a] < 0 || c[a] >= cells_[a]) return false;
    return true;
  }
  /// Returns the distance in cells to the nearest cell where f may be 0. The distance is the
  /// maximum over the three axes.
  int clearance(const Cell& c) const { return clear_[number(c)]; }
  /// Returns a lower bound of the distance of x, a point in the grid, from the zeros of f.
  double free_distance(const Vec3& x) const {
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
    squared = std::max(squared, spline.largest_squared_gradient());
    if (!spline.touches_zero(slack) || !spline.bezier().touches_zero(slack)) return;
    clear_[number(c)] = 0;
    for (int a = 0; a < 3; ++a) {
      low[a] = std::min(low[a], c[a]);
      high[a] = std::max(high[a], c[a] + 1);
    }
  });
  if (high[0] == 0) throw InputError("the surface would enclose no volume");
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

/// Extends the clearances of all cells (distances to cells where f may be 0) along an axis. The new
/// clearance of a cell is the minimum over all cells c in its line along the axis of max(distance
/// to c, clearance of c along the previous axes).
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

/// A straight line through a grid, which steps through the cells where f may be 0 and skips the
/// others.
class LevelLine {
 public:
  /// side: the sign of f at the start.
  LevelLine(const LevelGrid& grid, const Vec3& x, const Vec3& d, double side)
      : grid_(grid),
        from_(grid.place(x)),
        speed_(d / grid.spacing()),
        per_cell_(speed_.cwiseInverse()),
        side_(side) {}

  /// Returns the first change of sign of f after `start`; nullopt if the line leaves the grid
  /// first.
  std::optional<double> first_change(double start) {
    at_ = start;
    for (int a = 0; a < 3; ++a) cell_[a] = cell_at(a);
    while (grid_.has(cell_)) {
      const int clearance = grid_.clearance(cell_);
      const Leaving leaving = exit_distance_of(std::max(clearance - 1, 0));
      if (clearance == 0 && leaving.ray_length - at_ > shortest * grid_.spacing())
        if (const auto ray_length = change_before(leaving.ray_length)) return ray_length;
      go_on(leaving);
    }
    return std::nullopt;
  }

 private:
  // Shortest piece of the line, in cells, that is searched for a change of sign
  static constexpr double shortest = 1e-12;

  int cell_at(int axis) const {
    return static_cast<int>(std::floor(from_[axis] + at_ * speed_[axis]));
  }

  /// Exit of the line from the cube that contains all cells within `wide` cells of the current
  /// cell.
  struct Leaving {
    double ray_length;
    int axis, wide;
  };
  Leaving exit_distance_of(int wide) const {
    Leaving leaving{no_crossing, 0, wide};
    for (int a = 0; a < 3; ++a) {
      if (speed_[a] == 0) continue;
      const double ray_length =
          ((speed_[a] > 0 ? cell_[a] + wide + 1 : cell_[a] - wide) - from_[a]) * per_cell_[a];
      if (ray_length < leaving.ray_length) leaving = {ray_length, a, wide};
    }
    return leaving;
  }
  void go_on(const Leaving& leaving) {
    at_ = std::max(at_, leaving.ray_length);
    for (int a = 0; a < 3; ++a) {
      if (a == leaving.axis)
        cell_[a] += speed_[a] > 0 ? leaving.wide + 1 : -leaving.wide - 1;
      else
        cell_[a] = std::clamp(cell_at(a), cell_[a] - leaving.wide, cell_[a] + leaving.wide);
    }
  }

  /// Returns where f changes its sign within this cell. If the line starts on a zero of f, this
  /// zero is divided out.
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
  /// Start and direction of the line in units of cells, and length per cell along each axis.
  Vec3 from_, speed_, per_cell_;
  double side_, at_ = 0;
  LevelGrid::Cell cell_ = {};
  /// Level of side * f whose crossing is searched: 0, or the value at the start if that is
  /// negative.
  std::optional<double> level_ = {};
};

/// Implements LevelSurface::crossing_distance().
double distance_to_level(const LevelGrid& grid, const Vec3& x, const Vec3& d, double side) {
  const Box& bounds = grid.bounds();
  const double start = bounds.distance(x) > 0 ? entry_distance(bounds, x, d) : 0;
  const auto ray_length =
      start < no_crossing ? LevelLine(grid, x, d, side).first_change(start) : std::nullopt;
  if (ray_length) return *ray_length;
  return side > 0 || start > 0 ? no_crossing : exit_distance(bounds, x, d);
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
      is_probably_convex_(seems_convex(*grid_)) {}

double LevelSurface::distance(const Vec3& x) const {
  const double beyond = bounds().distance(x);
  if (beyond >= spacing()) return beyond;
  const double f = grid_->f().excess(x), least = std::max(beyond, grid_->free_distance(x));
  return std::copysign(std::max(std::abs(f) / grid_->steepest(), least), f);
}

Vec3 LevelSurface::normal(const Vec3& x) const {
  return grid_->f().gradient(x).gradient.normalized();
}

Mat3 LevelSurface::curvature(const Vec3& x) const {
  const IndexHessian jet = grid_->f().hessian(x);
  const double gradient_norm = jet.gradient.norm();
  const Vec3 n = jet.gradient / gradient_norm;
  return (jet.hessian - n * (n.transpose() * jet.hessian)) / gradient_norm;
}

Vec3 LevelSurface::projected(const Vec3& x) const {
  constexpr int newton_steps = 4;
  Vec3 at = x;
  for (int i = 0; i < newton_steps; ++i) {
    const Vec3 gradient = grid_->f().gradient(at).gradient;
    at -= gradient * (grid_->f().excess(at) / gradient.squaredNorm());
  }
  return at;
}

double LevelSurface::crossing_distance(const Vec3& x, const Vec3& d, double sign) const {
  return distance_to_level(*grid_, x, d, sign);
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
