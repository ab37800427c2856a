#pragma once

#include "grin/rays/ray.h"
#include "grin/rays/ray_jump.h"
#include "grin/space/straight_stage.h"
#include "grin/ways/way.h"

namespace flatspeckle::grin {

/// What WaySearch asks of space, where light goes straight within a part: rays of RayState, with
/// tangents where these are not null, from a point in a part or on its surface.
template <RenderPlan plan>
class StraightLegs {
 public:
  /// Refers to the stage.
  explicit StraightLegs(const StraightStage<plan>& stage) : stage_(stage) {}

  const Regions& regions() const { return stage_.regions(); }
  bool are_alike(Part a, Part b) const { return stage_.are_alike(a, b); }
  bool is_alone(Part part) const { return stage_.is_alone(part); }
  double index(const PathPoint& p) const { return 1 + stage_.excess(p.part); }
  RayState start(const PathPoint& p, const Vec3& direction) const {
    return {p.x, index(p) * direction};
  }

  /// On to the surface of a body; nothing where the leg does not end on one.
  std::optional<Meeting> to_surface(Part part, RayState& ray, RayTangent* tangent,
                                    RandomStream&) const {
    const double n = ray.v.norm();
    const Vec3 d = ray.v / n;
    const auto [way, end] = stage_.way_to_surface({ray.x, part}, d);
    if (end == at_boundary) return std::nullopt;
    advance(part, way / n, 1, ray, tangent);
    return Meeting{end, regions().beyond(part, end, ray.x, d)};
  }
  int steps(Part, double) const { return 1; }
  void advance(Part, double sigma, int, RayState& ray, RayTangent* tangent) const {
    ray.x += sigma * ray.v;
    const double square = ray.v.squaredNorm();
    ray.arc_length += sigma * std::sqrt(square);
    ray.optical_path += sigma * square;
    if (tangent) tangent->dx += sigma * tangent->dv;
  }
  /// A last leg is not refracted and does not leave the stage.
  bool stays(Part part, const RayState& start, double sigma) const {
    const double n = start.v.norm();
    return stage_.way_to_jump({start.x, part}, start.v / n) >= (1 - 1e-9) * sigma * n;
  }
  /// offer(sigma, squared distance) where a leg comes closest to x.
  template <class Offer>
  void approach(Part part, const RayState& ray, const Vec3& x, const Offer& offer) const {
    const double n = ray.v.norm();
    const double way = stage_.way_to_jump({ray.x, part}, ray.v / n);
    const double sigma = std::min((x - ray.x).dot(ray.v) / (n * n), way / n);
    if (sigma > 0) offer(sigma, (ray.x + sigma * ray.v - x).squaredNorm());
  }
  /// Of neighbours too, by the tangent: on to the plane of parallel light, or back to it where the
  /// ray goes away from it.
  PlaneCrossing to_plane(Part part, const ParallelLight& light, RayState& ray,
                         RayTangent* tangent) const {
    const double sigma = (light.x - ray.x).dot(light.direction) / ray.v.dot(light.direction);
    if (!std::isfinite(sigma)) return {};
    advance(part, sigma, 1, ray, tangent);
    return {sigma > 0, sigma};
  }
  RayJump jump(Part from, const Meeting& at, const RayState& ray) const {
    const auto side = [&](Part part) { return IndexGradient{stage_.excess(part), Vec3::Zero()}; };
    return RayJump(regions().surface(at.surface), ray, side(from), side(at.beyond));
  }

  double extinction(Part part) const { return stage_.medium(part).mu_t(); }
  double reference(Part part) const { return stage_.medium(part).reference(); }
  double transmitted(Part part, const RayState& start, double length, RandomStream& random) const {
    const Vec3 d = start.v.normalized();
    const auto path = [&](double s) -> Vec3 { return start.x + s * d; };
    return stage_.medium(part).template transmitted<plan>(path, length, random);
  }

 private:
  const StraightStage<plan>& stage_;
};

}  // namespace flatspeckle::grin
