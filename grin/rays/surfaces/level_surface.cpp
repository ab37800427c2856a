#include "grin/rays/surfaces/level_surface.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "grin/rays/surfaces/level_grid.h"
#include "grin/rays/surfaces/straight_way.h"

namespace flatspeckle::grin {

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
