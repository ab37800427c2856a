#include "grin/rays/surfaces/level_surface.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "grin/rays/surfaces/level_grid.h"
#include "grin/rays/surfaces/level_way.h"
#include "grin/rays/surfaces/straight_way.h"

namespace flatspeckle::grin {

namespace {

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
