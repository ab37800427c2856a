#pragma once

#include "grin/rays/ray_jump.h"
#include "grin/space/part_medium.h"
#include "grin/space/space.h"
#include "grin/space/stage.h"
#include "grin/surfaces/straight_way.h"

namespace flatspeckle::grin {

/// Where a flight is after a leg of it, within one part.
enum class LegEnd { collision, boundary, body };

/// Through the body's surface so often at most: what total reflection traps is lost.
inline constexpr int most_legs = 1000;

/// A leg within one part, which absorbs and does not scatter, leaves as much of the light.
inline void attenuate(Flight& flight, double weight) {
  if (flight.point.part == Part::body) flight.absorbed_in_body += flight.weight - weight;
  flight.weight = weight;
}

/// A stage for light that goes straight within a part.
template <RenderPlan plan>
class StraightStage {
 public:
  explicit StraightStage(const Stage& stage)
      : boundary_(stage.boundary),
        media_{PartMedium(stage.medium, mean_density(stage, false)), {}} {
    if (!stage.body) return;
    body_ = stage.body->surface;
    media_[1] = PartMedium(stage.body->medium, mean_density(stage, true));
  }

  const PartMedium& medium(Part part) const {
    return media_[plan.body && part == Part::body ? 1 : 0];
  }
  /// What a part lies in.
  const Surface& container(Part part) const {
    return plan.body && part == Part::body ? *body_ : boundary_;
  }

  bool has_body() const { return plan.body && body_; }

  /// To the next collision or to the end of the part. rise: gradient of the logarithm of what light
  /// is worth, along which flights are stretched; or null.
  LegEnd fly(Flight& flight, double index, RandomStream& random, const Vec3* rise = nullptr) const {
    const Vec3 x = flight.point.x, d = flight.direction;
    const auto path = [&](double s) -> Vec3 { return x + s * d; };
    auto [way, end] = way_to_surface(flight.point, d);
    const PartMedium& in = medium(flight.point.part);
    const double pull = rise && in.is_uniform() ? rise->dot(d) / in.mu_t() : 0;
    const double free = pull > 0 ? stretched(flight, in.mu_t(), pull, way, random)
                                 : in.template free_path<plan>(path, way, random);
    if (free < way) {
      way = free;
      end = LegEnd::collision;
    }
    flight.point.x = path(way);
    flight.arc_length += way;
    flight.optical_path += index * way;
    if constexpr (plan.scatters) flight.optical_depth += in.reference() * way;
    if constexpr (plan.absorbs)
      if (!in.scatters())
        attenuate(flight, flight.weight * in.template transmitted<plan>(path, way, random));
    return end;
  }

  /// At the body's surface, where it refracts: to the other side or back. The tangent, if not
  /// null, goes on too.
  void cross(Flight& flight, const IndexGradient& body, const IndexGradient& around,
             RayTangent* tangent, RandomStream& random) const {
    const bool leaves = flight.point.part == Part::body;
    const IndexGradient& from = leaves ? body : around;
    RayState ray{flight.point.x, (1 + from.excess) * flight.direction};
    const RayJump jump(*body_, ray, from, leaves ? around : body);
    const double reflectance = jump.reflectance();
    const bool reflected = jump.is_total() || random.uniform() < reflectance;
    jump.pass(reflected, ray, tangent);
    flight.crosses_body = true;
    flight.is_joinable = flight.passages.count < Passages::most && joins_through();
    if (flight.is_joinable) flight.passages.add(reflected);
    flight.optical_depth -= std::log(reflected ? reflectance : 1 - reflectance);
    flight.direction = ray.v.normalized();
    if (!reflected) flight.point.part = beyond(flight.point.part);
  }
  /// The same where it does not.
  void pass(Flight& flight) const {
    flight.crosses_body = true;
    flight.point.part = beyond(flight.point.part);
  }
  /// Whether ways can be found that the body's surface refracts.
  bool joins_through() const { return plan.body && body_ && has_curvature(*body_); }

  std::optional<Join> join(const PathPoint& p, const PathPoint& q, double index,
                           RandomStream& random) const {
    if (plan.body && p.part != q.part) return std::nullopt;
    const Vec3 chord = q.x - p.x;
    const double square = chord.squaredNorm(), length = std::sqrt(square);
    if (!(length > 0)) return std::nullopt;
    const Vec3 d = chord / length;
    if (is_blocked(p, d, length)) return std::nullopt;
    const PartMedium& in = medium(p.part);
    const auto path = [&](double s) -> Vec3 { return p.x + s * d; };
    return Join{.start_direction = d,
                .end_direction = d,
                .spreading = square,
                .optical_path = index * length,
                .optical_depth = in.reference() * length,
                .transmittance = in.template transmitted<plan>(path, length, random),
                .multiplicity = 1};
  }

  /// Through the body's surface as if there were none.
  std::optional<Join> join_through(const PathPoint& p, const PathPoint& q, double index,
                                   RandomStream& random) const {
    const Vec3 chord = q.x - p.x;
    const double square = chord.squaredNorm(), length = std::sqrt(square);
    if (!(length > 0)) return std::nullopt;
    const Vec3 d = chord / length;
    Join join{.start_direction = d,
              .end_direction = d,
              .spreading = square,
              .optical_path = index * length,
              .optical_depth = 0,
              .transmittance = 1,
              .multiplicity = 1};
    const bool arrives = for_each_part(p, d, length, [&](Part part, double from, double to) {
      const auto path = [&](double s) -> Vec3 { return p.x + (from + s) * d; };
      join.optical_depth += medium(part).reference() * (to - from);
      join.transmittance *= medium(part).template transmitted<plan>(path, to - from, random);
    });
    return arrives ? std::optional(join) : std::nullopt;
  }

  /// The straight way of parallel light to a point, through the body's surface where that is clear.
  std::vector<BeamWay> ways_to_beam(const PathPoint& p, const ParallelLight& light, double index,
                                    bool is_clear, RandomStream& random) const {
    const double length = (p.x - light.x).dot(light.direction);
    if (!(length > 0)) return {};
    const PathPoint from{p.x - length * light.direction, p.part};
    const auto join =
        is_clear ? join_through(p, from, index, random) : this->join(p, from, index, random);
    if (!join) return {};
    return {BeamWay{.start_direction = join->start_direction,
                    .place = from.x,
                    .thinning = 1,
                    .orientation = 1,
                    .arc_length = length,
                    .optical_path = join->optical_path,
                    .transmittance = join->transmittance}};
  }

  /// Of the straight line between two points at the least, whether light goes it or not.
  double least_depth(const PathPoint& p, const PathPoint& q) const {
    const Vec3 chord = q.x - p.x;
    const double length = chord.norm();
    const bool in_one_part = p.part == q.part && (p.part == Part::body || !body_);
    if (!plan.body || in_one_part) return medium(p.part).least_extinction() * length;
    double depth = 0;
    for_each_part(p, chord / length, length, [&](Part part, double from, double to) {
      depth += medium(part).least_extinction() * (to - from);
    });
    return depth;
  }

  /// From a point of a part or on its surface to where it ends.
  struct WayOut {
    double length;
    LegEnd end;
  };
  WayOut way_to_surface(const PathPoint& p, const Vec3& d) const {
    if (plan.body && p.part == Part::body) return {way_out(*body_, p.x, d), LegEnd::body};
    const double out = way_out(boundary_, p.x, d);
    if constexpr (plan.body) {
      if (body_) {
        const double in = way_in(*body_, p.x, d);
        if (in < out) return {in, LegEnd::body};
      }
    }
    return {out, LegEnd::boundary};
  }

 private:
  static double stretched(Flight& flight, double mu_t, double pull, double way,
                          RandomStream& random) {
    const StretchedFlight of(mu_t, pull);
    const double free = of.sample(random.uniform());
    flight.stretched = free < way ? of.weight(free) : of.weight_beyond(way);
    return free;
  }

  /// Calls use(part, from, to) for the stretches of a straight line. Returns whether it is within
  /// the boundary.
  template <class Use>
  bool for_each_part(PathPoint at, const Vec3& d, double length, const Use& use) const {
    const double shorter = (1 - 1e-9) * length;  // the end may be on a surface itself
    const Vec3 start = at.x;
    double from = 0;
    for (int leg = 0; leg < most_legs; ++leg) {
      const auto [way, end] = way_to_surface(at, d);
      if (from + way >= shorter) {
        use(at.part, from, length);
        return true;
      }
      if (end == LegEnd::boundary) return false;
      use(at.part, from, from + way);
      from += way;
      at = {start + from * d, beyond(at.part)};
    }
    return false;
  }

  bool is_blocked(const PathPoint& p, const Vec3& d, double length) const {
    // The end may be on the surface itself.
    const double shorter = (1 - 1e-9) * length;
    if (!is_convex(container(p.part)) && way_out(container(p.part), p.x, d) < shorter) return true;
    return plan.body && p.part == Part::stage && body_ && way_in(*body_, p.x, d) < shorter;
  }

  Surface boundary_;
  std::optional<Surface> body_;
  std::array<PartMedium, 2> media_;
};

}  // namespace flatspeckle::grin
