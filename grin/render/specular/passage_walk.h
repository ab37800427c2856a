#pragma once

#include <algorithm>
#include <cmath>
#include <optional>
#include <tuple>
#include <utility>
#include <vector>

#include "grin/media/scattering/start_directions.h"
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
    const LegEnd end = space_.end_on_surface(ray);
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

/// What random rays look for.
enum class Seek {
  strongest,    ///< light goes where most of it goes
  reflections,  ///< and ways with many reflections as often
};

/// Rays from a point, in a space without collisions, that are refracted or reflected at surfaces of
/// bodies: what searches for ways of light are made of. A leg goes from one of these places to the
/// next, through surfaces where the index does not jump.
class PassageWalk {
 public:
  /// Refers to the legs.
  PassageWalk(const Legs& legs, const PathPoint& from, Seek seek)
      : legs_(legs), from_(from), seeks_reflections_(seek == Seek::reflections) {
    aim_at_bodies();
  }

  /// A random direction: towards a body from outside of all, towards those that lie over the part
  /// or anywhere from inside of one, and then as `start` says about `chord`. Ways with many
  /// reflections begin close together at a body's rim.
  Vec3 start_direction(const Vec3& chord, const StartDirections& start,
                       RandomStream& random) const {
    if (cones_.empty() || (!is_outside_ && random.uniform() < 0.5))
      return start.sample(chord, random);
    const Cone& cone = cones_[pick(random)];
    const double u = random.uniform();
    const double inside = seeks_reflections_ && random.uniform() < 0.5 ? 1 - u * u * u : u;
    return random_turn(cone.axis, cone.one_minus_cosine * inside, random);
  }

  /// A ray starts outside of all bodies, towards one.
  bool aims_at_bodies() const { return is_outside_; }

  /// The start of a ray's last leg.
  struct Head {
    Part part;
    RayState ray;
    double chance = 1;              ///< Fresnel's, that light takes the passages so far
    int hollows = 0;                ///< of these, at surfaces that are not convex
    Vec3 first_met = Vec3::Zero();  ///< where it is refracted or reflected first
  };
  /// Through the passages given, with a tangent where that is not null; nothing where no ray goes.
  std::optional<Head> follow(const Vec3& direction, const Passages& passages, RayTangent* tangent,
                             RandomStream& random) const {
    Head head{from_.part, legs_.start(from_, direction)};
    for (int i = 0; i < passages.count; ++i) {
      const auto met =
          to_jump(head.part, head.ray, tangent, random, [](Part, const RayState&, double) {});
      if (!met) return std::nullopt;
      if (i == 0) head.first_met = head.ray.x;
      const RayJump jump = legs_.jump(head.part, *met, head.ray);
      const bool reflects = passages.reflects(i);
      head.chance *= jump.chance(reflects);
      head.hollows += jump.is_hollow();
      if (!(head.chance > 0)) return std::nullopt;
      jump.pass(reflects, head.ray, tangent);
      if (!reflects) head.part = met->beyond;
    }
    return head;
  }

  /// Refracted wherever that can be, else reflected. Calls at_leg(passages so far, part, ray) at
  /// the start of each leg.
  template <class AtLeg>
  void refracted(const Vec3& direction, RandomStream& random, const AtLeg& at_leg) const {
    walk(direction, random, at_leg,
         [](const Head&, const Passages&, const Jump& jump, double) -> std::optional<bool> {
           return jump.of_ray.is_total();
         });
  }
  /// The same, refracted or reflected at random; who seeks reflections is told both.
  template <class AtLeg>
  void at_random(const Vec3& direction, RandomStream& random, const AtLeg& at_leg) const {
    walk(direction, random, at_leg,
         [&](const Head& head, const Passages& met, const Jump& jump,
             double depth) -> std::optional<bool> {
           const bool goes_on = met.count < free_passages || random.uniform() < std::exp(-depth);
           if (!goes_on) return std::nullopt;
           const double chance = chance_to_reflect(jump.of_ray.reflectance());
           const bool reflects = random.uniform() < chance;
           if (seeks_reflections_ && chance >= faintest && !jump.of_ray.is_total())
             step(!reflects, jump, head, met, at_leg);
           return reflects;
         });
  }

  /// Calls use(part, start, arc length) for the stretches of a way of this arc length in all.
  template <class Use>
  void for_each_leg(const Vec3& direction, const Passages& passages, double arc_length,
                    RandomStream& random, const Use& use) const {
    RayState ray = legs_.start(from_, direction);
    Part part = from_.part;
    for (int i = 0; i < passages.count; ++i) {
      const auto met = to_jump(part, ray, nullptr, random, use);
      if (!met) return;
      const bool reflects = passages.reflects(i);
      legs_.jump(part, *met, ray).pass(reflects, ray);
      if (!reflects) part = met->beyond;
    }
    last_leg(part, ray, arc_length, random, use);
  }

 private:
  static constexpr int free_passages = 3;   // then rays lose at roulette by extinction
  static constexpr double faintest = 1e-6;  // reflectance where the index jumps at all

  /// Directions in which a body may lie.
  struct Cone {
    Vec3 axis;
    double one_minus_cosine;
  };
  void aim_at_bodies() {
    const Regions& regions = legs_.regions();
    is_outside_ = from_.part == around && regions.parts() > 1;
    for (Part body = from_.part + 1; body < regions.parts(); ++body) {
      const Surface& surface = regions.surface(body);
      const auto [low, high] = bounds(surface);
      const Sphere* sphere = std::get_if<Sphere>(&surface);
      const double radius = sphere ? sphere->radius : (high - low).norm() / 2;
      const Vec3 to_centre = (low + high) / 2 - from_.x;
      const double distance = to_centre.norm();
      if (distance > radius)
        cones_.push_back(
            {to_centre / distance, 1 - std::sqrt(1 - radius / distance * (radius / distance))});
      else
        is_outside_ = false;
    }
  }
  std::size_t pick(RandomStream& random) const {
    if (cones_.size() == 1) return 0;
    const auto count = static_cast<double>(cones_.size());
    return std::min(static_cast<std::size_t>(random.uniform() * count), cones_.size() - 1);
  }

  /// On to where the index jumps at a surface that can be refracted through; use(part, start, arc
  /// length) for what is on the way.
  template <class Use>
  std::optional<Meeting> to_jump(Part& part, RayState& ray, RayTangent* tangent,
                                 RandomStream& random, const Use& use) const {
    for (int stretch = 0; stretch < legs_.regions().most_legs(); ++stretch) {
      const RayState start = ray;
      const auto met = legs_.to_surface(part, ray, tangent, random);
      if (!met) return std::nullopt;
      use(part, start, ray.arc_length - start.arc_length);
      if (!legs_.are_alike(part, met->beyond)) return met;
      part = met->beyond;
    }
    return std::nullopt;
  }
  /// From a state on, until the way has this arc length.
  template <class Use>
  void last_leg(Part part, RayState ray, double arc_length, RandomStream& random,
                const Use& use) const {
    for (int stretch = 0; stretch < legs_.regions().most_legs() && !legs_.is_alone(part);
         ++stretch) {
      const RayState start = ray;
      const auto met = legs_.to_surface(part, ray, nullptr, random);
      if (!met || ray.arc_length >= arc_length || !legs_.are_alike(part, met->beyond))
        return use(part, start, arc_length - start.arc_length);
      use(part, start, ray.arc_length - start.arc_length);
      part = met->beyond;
    }
    use(part, ray, arc_length - ray.arc_length);
  }

  struct Jump {
    RayJump of_ray;
    Part beyond;
  };
  /// decide(head, passages, jump, optical depth of the leg): whether it reflects; nothing to end.
  template <class AtLeg, class Decide>
  void walk(const Vec3& direction, RandomStream& random, const AtLeg& at_leg,
            const Decide& decide) const {
    Head head{from_.part, legs_.start(from_, direction)};
    Passages met;
    at_leg(met, head.part, head.ray);
    while (met.count < Passages::most) {
      double depth = 0;
      const auto pass = [&](Part part, const RayState&, double length) {
        depth += legs_.extinction(part) * length;
      };
      const auto at = to_jump(head.part, head.ray, nullptr, random, pass);
      if (!at) return;
      const Jump jump{legs_.jump(head.part, *at, head.ray), at->beyond};
      const auto reflects = decide(head, met, jump, depth);
      if (!reflects) return;
      std::tie(head, met) = step(*reflects, jump, head, met, at_leg);
    }
  }
  /// Through or off the surface, to the start of the next leg.
  template <class AtLeg>
  static std::pair<Head, Passages> step(bool reflects, const Jump& jump, Head head, Passages met,
                                        const AtLeg& at_leg) {
    met.add(reflects);
    jump.of_ray.pass(reflects, head.ray);
    if (!reflects) head.part = jump.beyond;
    at_leg(met, head.part, head.ray);
    return {head, met};
  }
  /// Faint reflections are worth a look; none where the index hardly jumps.
  double chance_to_reflect(double reflectance) const {
    if (reflectance < faintest || reflectance >= 1) return reflectance;
    return std::clamp(seeks_reflections_ ? std::sqrt(reflectance) : reflectance, 0.1, 0.9);
  }

  const Legs& legs_;
  PathPoint from_;
  bool seeks_reflections_;
  bool is_outside_ = false;
  std::vector<Cone> cones_;
};

}  // namespace flatspeckle::grin
