#include "grin/surfaces/level_surface.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "grin/surfaces/level_grid.h"
#include "grin/surfaces/level_way.h"
#include "grin/surfaces/straight_way.h"

namespace flatspeckle::grin {

LevelSurface::LevelSurface(const Vec3& origin, double spacing, const std::array<int, 3>& nodes,
                           std::vector<double> coefficients, double meant_volume)
    : grid_(std::make_shared<const LevelGrid>(origin, spacing, nodes, std::move(coefficients))),
      meant_volume_(meant_volume) {}

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
