#pragma once

#include <algorithm>
#include <cmath>
#include <optional>
#include <tuple>
#include <utility>

#include "grin/media/start_directions.h"
#include "grin/rays/ray_jump.h"
#include "grin/space/space.h"
#include "grin/space/stage.h"

namespace flatspeckle::grin {

/// What random rays look for.
enum class Seek {
  strongest,    ///< light goes where most of it goes
  reflections,  ///< and ways with many reflections as often
};

/// Rays from a point, in a space without collisions, that are refracted or reflected at the body's
/// surface: what searches for ways of light are made of.
///
/// Legs: a space without collisions, as straight_legs.h says.
template <class Legs>
class PassageWalk {
 public:
  /// Refers to the legs.
  PassageWalk(const Legs& legs, const PathPoint& from, Seek seek)
      : legs_(legs), from_(from), seeks_reflections_(seek == Seek::reflections) {
    if (legs.has_body()) aim_at_body();
  }

  /// A random direction: towards the body from outside of it, else as `start` says about `chord`.
  /// Ways with many reflections begin close together at the body's rim.
  Vec3 start_direction(const Vec3& chord, const StartDirections& start,
                       RandomStream& random) const {
    if (!is_outside_) return start.sample(chord, random);
    const double u = random.uniform();
    const double inside = seeks_reflections_ && random.uniform() < 0.5 ? 1 - u * u * u : u;
    return random_turn(axis_, one_minus_cosine_ * inside, random);
  }

  /// A ray starts so that it meets the body.
  bool aims_at_body() const { return is_outside_; }

  /// The start of a ray's last leg.
  struct Head {
    Part part;
    RayState ray;
    double chance = 1;              ///< Fresnel's, that light takes the passages so far
    Vec3 first_met = Vec3::Zero();  ///< where it first meets the body's surface, if it does
  };
  /// Through the passages given, with a tangent where that is not null; nothing where no ray goes.
  std::optional<Head> follow(const Vec3& direction, const Passages& passages, RayTangent* tangent,
                             RandomStream& random) const {
    Head head{from_.part, legs_.start(from_, direction)};
    for (int i = 0; i < passages.count; ++i) {
      if (!legs_.to_body(head.part, head.ray, tangent, random)) return std::nullopt;
      if (i == 0) head.first_met = head.ray.x;
      const RayJump jump = legs_.jump(head.part, head.ray);
      const bool reflects = passages.reflects(i);
      const double reflectance = jump.reflectance();
      head.chance *= reflects ? reflectance : 1 - reflectance;
      if (!(head.chance > 0)) return std::nullopt;
      jump.pass(reflects, head.ray, tangent);
      if (!reflects) head.part = beyond(head.part);
    }
    return head;
  }

  /// Refracted wherever that can be, else reflected. Calls at_leg(passages so far, part, ray) at
  /// the start of each leg.
  template <class AtLeg>
  void refracted(const Vec3& direction, RandomStream& random, const AtLeg& at_leg) const {
    walk(direction, random, at_leg,
         [](const Head&, const Passages&, const RayJump& jump, double) -> std::optional<bool> {
           return jump.is_total();
         });
  }
  /// The same, refracted or reflected at random; who seeks reflections is told both.
  template <class AtLeg>
  void at_random(const Vec3& direction, RandomStream& random, const AtLeg& at_leg) const {
    walk(direction, random, at_leg,
         [&](const Head& head, const Passages& met, const RayJump& jump,
             double length) -> std::optional<bool> {
           const bool goes_on = met.count < free_passages ||
                                random.uniform() < std::exp(-legs_.extinction(head.part) * length);
           if (!goes_on) return std::nullopt;
           const double chance = chance_to_reflect(jump.reflectance());
           const bool reflects = random.uniform() < chance;
           if (seeks_reflections_ && chance >= faintest && !jump.is_total())
             step(!reflects, jump, head, met, at_leg);
           return reflects;
         });
  }

  /// Calls use(part, start, arc length) for the legs of a way of this arc length in all.
  template <class Use>
  void for_each_leg(const Vec3& direction, const Passages& passages, double arc_length,
                    RandomStream& random, const Use& use) const {
    RayState ray = legs_.start(from_, direction);
    Part part = from_.part;
    for (int i = 0; i < passages.count; ++i) {
      const RayState start = ray;
      if (!legs_.to_body(part, ray, nullptr, random)) return;
      use(part, start, ray.arc_length - start.arc_length);
      const bool reflects = passages.reflects(i);
      legs_.jump(part, ray).pass(reflects, ray);
      if (!reflects) part = beyond(part);
    }
    use(part, ray, arc_length - ray.arc_length);
  }

 private:
  static constexpr int free_passages = 3;   // then rays lose at roulette by extinction
  static constexpr double faintest = 1e-6;  // reflectance where the index jumps at all

  /// The cone of directions in which the body may lie.
  void aim_at_body() {
    const auto [low, high] = bounds(legs_.body());
    const Sphere* sphere = std::get_if<Sphere>(&legs_.body());
    const double radius = sphere ? sphere->radius : (high - low).norm() / 2;
    const Vec3 to_centre = (low + high) / 2 - from_.x;
    const double distance = to_centre.norm();
    is_outside_ = from_.part == Part::stage && distance > radius;
    if (!is_outside_) return;
    axis_ = to_centre / distance;
    one_minus_cosine_ = 1 - std::sqrt(1 - radius / distance * (radius / distance));
  }

  /// decide(head, passages, jump, length of the leg): whether it reflects; nothing to end.
  template <class AtLeg, class Decide>
  void walk(const Vec3& direction, RandomStream& random, const AtLeg& at_leg,
            const Decide& decide) const {
    Head head{from_.part, legs_.start(from_, direction)};
    Passages met;
    at_leg(met, head.part, head.ray);
    while (met.count < Passages::most) {
      const double before = head.ray.arc_length;
      if (!legs_.to_body(head.part, head.ray, nullptr, random)) return;
      const RayJump jump = legs_.jump(head.part, head.ray);
      const auto reflects = decide(head, met, jump, head.ray.arc_length - before);
      if (!reflects) return;
      std::tie(head, met) = step(*reflects, jump, head, met, at_leg);
    }
  }
  /// Through or off the surface, to the start of the next leg.
  template <class AtLeg>
  static std::pair<Head, Passages> step(bool reflects, const RayJump& jump, Head head, Passages met,
                                        const AtLeg& at_leg) {
    met.add(reflects);
    jump.pass(reflects, head.ray);
    if (!reflects) head.part = beyond(head.part);
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
  Vec3 axis_;
  double one_minus_cosine_ = 2;
};

}  // namespace flatspeckle::grin
