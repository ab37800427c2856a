#pragma once

#include "grin/rays/marching/ray_jump.h"
#include "grin/render/flights/space.h"

namespace flatspeckle::grin {

/// Where a ray meets the surface of a body, and the part beyond.
struct Meeting {
  LegEnd surface;
  Part beyond;
};

/// Where a leg crosses the plane of parallel light.
struct PlaneCrossing {
  bool is_reached = false;  ///< on the way of the ray
  double sigma = 0;         ///< of the leg, ray parameter
};

/// What searches for ways of light ask of space: rays without collisions, with tangents where these
/// are not null, from a point in a part or on its surface.
class Legs {
 public:
  /// Refers to the space.
  explicit Legs(const Space& space) : space_(space), stage_(space.setup_->stage) {}

  const Regions& regions() const { return stage_.regions(); }
  bool are_alike(Part a, Part b) const { return stage_.are_alike(a, b); }
  bool is_alone(Part part) const { return stage_.is_alone(part); }
  double index(const PathPoint& p) const { return space_.index(p); }
  RayState start(const PathPoint& p, const Vec3& direction) const {
    return {p.x, index(p) * direction};
  }

  /// On to the surface of a body; nothing where the leg does not end on one.
  std::optional<Meeting> to_surface(Part part, RayState& ray, RayTangent* tangent,
                                    RandomStream& random) const {
    if (space_.is_curved(part)) return curved_to_surface(part, ray, tangent, random);
    const double n = ray.v.norm();
    const Vec3 d = ray.v / n;
    const auto [way, end] = regions().way_out({ray.x, part}, d);
    if (end == at_boundary) return std::nullopt;
    advance_straight(way / n, ray, tangent);
    return Meeting{end, regions().beyond(part, end, ray.x, d)};
  }
  int steps(Part part, double sigma) const {
    if (!space_.is_curved(part)) return 1;
    return static_cast<int>(std::clamp(std::ceil(sigma / step()), 1.0, 1e5));
  }
  void advance(Part part, double sigma, int steps, RayState& ray, RayTangent* tangent) const {
    if (!space_.is_curved(part)) return advance_straight(sigma, ray, tangent);
    space_.field_->advance(sigma, steps, ray, tangent);
  }
  /// A last leg is not refracted and does not leave the stage.
  bool stays(Part part, const RayState& start, double sigma) const {
    if (space_.is_curved(part)) return space_.stays_inside(start, sigma, steps(part, sigma));
    const double n = start.v.norm();
    return stage_.way_to_jump({start.x, part}, start.v / n) >= (1 - 1e-9) * sigma * n;
  }
  /// offer(sigma, squared distance) where a leg comes closest to x.
  template <class Offer>
  void approach(Part part, const RayState& ray, const Vec3& x, const Offer& offer) const {
    if (space_.is_curved(part)) return curved_approach(ray, x, offer);
    const double n = ray.v.norm();
    const double way = stage_.way_to_jump({ray.x, part}, ray.v / n);
    const double sigma = std::min((x - ray.x).dot(ray.v) / (n * n), way / n);
    if (sigma > 0) offer(sigma, (ray.x + sigma * ray.v - x).squaredNorm());
  }
  /// Of neighbours too, by the tangent: on to the plane of parallel light, or back to it where a
  /// straight ray goes away from it.
  PlaneCrossing to_plane(Part part, const ParallelLight& light, RayState& ray,
                         RayTangent* tangent) const {
    if (space_.is_curved(part)) return curved_to_plane(light, ray, tangent);
    const double sigma = (light.x - ray.x).dot(light.direction) / ray.v.dot(light.direction);
    if (!std::isfinite(sigma)) return {};
    advance_straight(sigma, ray, tangent);
    return {sigma > 0, sigma};
  }
  RayJump jump(Part from, const Meeting& at, const RayState& ray) const {
    return RayJump(regions().surface(at.surface), ray, space_.side(from, ray.x),
                   space_.side(at.beyond, ray.x));
  }

  double extinction(Part part) const { return stage_.medium(part).mu_t(); }
  double reference(Part part) const { return stage_.medium(part).reference(); }
  double transmitted(Part part, const RayState& start, double length, RandomStream& random) const {
    const PartMedium& medium = stage_.medium(part);
    if (space_.is_curved(part)) {
      if (!medium.grid()) return transmittance(medium.mu_t(), length);
      return space_.field_->ratio_tracked(space_.leg_room(), start, length, random);
    }
    const Vec3 d = start.v.normalized();
    const auto path = [&](double s) -> Vec3 { return start.x + s * d; };
    return medium.transmitted(path, length, random);
  }

 private:
  static void advance_straight(double sigma, RayState& ray, RayTangent* tangent) {
    ray.x += sigma * ray.v;
    const double square = ray.v.squaredNorm();
    ray.arc_length += sigma * std::sqrt(square);
    ray.optical_path += sigma * square;
    if (tangent) tangent->dx += sigma * tangent->dv;
  }

  std::optional<Meeting> curved_to_surface(Part part, RayState& ray, RayTangent* tangent,
                                           RandomStream& random) const {
    if (!space_.joins_through()) return std::nullopt;
    static const PartMedium clear;
    double all = 1;
    const LegRoom room{space_.room(), clear, step()};
    if (space_.field_->fly(room, longest(), all, random, ray, tangent) != LegStop::surface)
      return std::nullopt;
    const LegEnd end = space_.end_at(ray.x);
    if (end == at_boundary) return std::nullopt;
    return Meeting{end, regions().beyond(part, end, ray.x, ray.v)};
  }
  template <class Offer>
  void curved_approach(RayState ray, const Vec3& x, const Offer& offer) const {
    const double h = step();
    double nearing = (x - ray.x).dot(ray.v);
    for (int i = 0; ray.arc_length <= longest(); ++i) {
      const RayState before = ray;
      const double was_nearing = nearing;
      space_.field_->advance(h, 1, ray, nullptr);
      if (!(ray.arc_length > before.arc_length)) return;
      nearing = (x - ray.x).dot(ray.v);
      const bool is_out = space_.room().distance(ray.x) > 0;
      if (was_nearing > 0 && nearing <= 0) {
        const double part_of_step = was_nearing / (was_nearing - nearing);
        const Vec3 closest = before.x + part_of_step * (ray.x - before.x);
        offer((i + part_of_step) * h, (closest - x).squaredNorm());
      } else if (is_out && nearing > 0) {
        offer((i + 1) * h, (ray.x - x).squaredNorm());
      }
      if (is_out) return;
    }
  }
  PlaneCrossing curved_to_plane(const ParallelLight& light, RayState& ray,
                                RayTangent* tangent) const {
    const auto ahead = [&](const RayState& at) { return (at.x - light.x).dot(light.direction); };
    for (int i = 0; ray.arc_length <= longest(); ++i) {
      const RayState before = ray;
      const RayTangent was = tangent ? *tangent : RayTangent();
      space_.field_->advance(step(), 1, ray, tangent);
      if (!(ray.arc_length > before.arc_length)) return {};
      if (ahead(before) > 0 && ahead(ray) <= 0) {
        if (tangent) *tangent = was;
        const double sigma = last_step(light, before, ray);
        ray = before;
        space_.field_->advance(sigma, 1, ray, tangent);
        if (tangent) meet(light, ray, *tangent);
        return {space_.room().distance(ray.x) <= 1e-6 * step(), i * step() + sigma};
      }
      if (space_.room().distance(ray.x) > 0) return {};
    }
    return {};
  }
  /// From a state to the plane of a light, no further than another: secants.
  double last_step(const ParallelLight& light, const RayState& from, const RayState& to) const {
    const auto ahead = [&](const Vec3& x) { return (x - light.x).dot(light.direction); };
    double low = 0, high = step(), at_low = ahead(from.x), at_high = ahead(to.x);
    for (int i = 0; i < 8; ++i) {
      const double sigma = low + (high - low) * at_low / (at_low - at_high);
      RayState ray = from;
      space_.field_->advance(sigma, 1, ray, nullptr);
      const double at = ahead(ray.x);
      if (std::abs(at) <= 1e-12 * step()) return sigma;
      (at > 0 ? low : high) = sigma;
      (at > 0 ? at_low : at_high) = at;
    }
    return high;
  }
  /// Neighbours as they meet the plane.
  void meet(const ParallelLight& light, const RayState& ray, RayTangent& tangent) const {
    const Eigen::RowVector3d sooner =
        -(light.direction.transpose() * tangent.dx) / light.direction.dot(ray.v);
    tangent.dx += ray.v * sooner;
    tangent.dv += ray_force(space_.field_->gradient(ray.x)) * sooner;
  }
  double step() const { return space_.setup_->options.step; }
  double longest() const { return space_.setup_->options.max_length; }

  const Space& space_;
  const StraightStage& stage_;
};

}  // namespace flatspeckle::grin
