#include "grin/render/stage/regions.h"

#include <cmath>

#include "core/error.h"
#include "grin/media/geometry/vector_values.h"

namespace flatspeckle::grin {

Regions::Regions(const Stage& stage, std::optional<double> farthest) {
  for (Part part = around; part < stage.parts(); ++part) surfaces_.push_back(stage.surface(part));
  has_fast_distance_.assign(surfaces_.size(), true);
  for (std::size_t part = surfaces_.size(); part-- > 0;) {
    const bool is_fast = std::holds_alternative<Box>(surfaces_[part]) ||
                         std::holds_alternative<Sphere>(surfaces_[part]);
    has_fast_distance_[part] =
        is_fast && (part + 1 == surfaces_.size() || has_fast_distance_[part + 1]);
  }
  if (stage.bodies.empty()) return;
  for (const Surface& surface : surfaces_)
    if (std::holds_alternative<LevelSurface>(surface)) most_segments_ = 10000;
  const auto [low, high] = bounds(stage.boundary);
  farthest_ = farthest.value_or(low.cwiseAbs().cwiseMax(high.cwiseAbs()).maxCoeff());
}

Part Regions::at(const Vec3& x) const {
  for (Part part = parts() - 1; part > around; --part)
    if (distance(surfaces_[part], x) < 0) return part;
  return around;
}

bool Regions::goes_into(Part body, const Vec3& x, const Vec3& d) const {
  const double outside = distance(surfaces_[body], x);
  if (std::abs(outside) > contact(x)) return outside < 0;
  return normal(surfaces_[body], x).dot(d) < 0;
}

double mean_density(const Stage& stage, Part part) {
  constexpr int points = 32;  // lattice points along each axis
  const ScatteringMedium& medium = stage.medium_in(part);
  if (!medium.density) return 1;
  const Regions regions(stage);
  const auto [low, high] = bounds(stage.surface(part));
  double sum = 0;
  int inside = 0;
  for (int point = 0; point < points * points * points; ++point) {
    const Vec3 at(point / points / points, point / points % points, point % points);
    const Vec3 share = (at + Vec3::Constant(0.5)) / points;
    const Vec3 x = low + share.cwiseProduct(high - low);
    if (regions.at(x) != part || distance(stage.boundary, x) > 0) continue;
    sum += (*medium.density)(x);
    ++inside;
  }
  return inside > 0 ? sum / inside : 1;
}

void require_in_stage(const Stage& stage, const char* key, const Vec3& x) {
  if (!(distance(stage.boundary, x) <= 1e-9 * x.norm()))
    throw InputError(key, listed(x), "must be inside the stage");
  const Part part = Regions(stage).at(x);
  if (part != around && stage.bodies[part - 1].is_opaque())
    throw InputError(key, listed(x), "must not be in a mirror or an absorbing body");
}

}  // namespace flatspeckle::grin
