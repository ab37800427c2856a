#pragma once

#include "grin/rays/marching/ray_jump.h"
#include "grin/render/stage/flight.h"
#include "grin/render/stage/part_medium.h"

namespace flatspeckle::grin {

/// A leg within one part, which absorbs and does not scatter, leaves as much of the light.
inline void attenuate(Flight& flight, double weight) {
  if (flight.point.part != around) flight.absorbed_in_body += flight.weight - weight;
  flight.weight = weight;
}

/// A stage for light that goes straight within a part.
class StraightStage {
 public:
  /// field_excess: of the part that the field fills, where it is the same everywhere.
  StraightStage(const Stage& stage, std::optional<double> field_excess) : regions_(stage) {
    for (Part part = around; part < stage.parts(); ++part) {
      const PartMedium medium(stage.medium_in(part), mean_density(stage, part));
      if (part != stage.field_part())
        add(medium, stage.excess_in(part));
      else
        add(medium, field_excess);
    }
  }

  const Regions& regions() const { return regions_; }
  const PartMedium& medium(Part part) const { return parts_[part].medium; }
  /// Index - 1 of a part where it is the same everywhere.
  double excess(Part part) const { return *parts_[part].excess; }

  /// Light goes from one part into the other as if they were one.
  bool are_alike(Part a, Part b) const { return parts_[a].first_alike == parts_[b].first_alike; }
  /// No other part is alike.
  bool is_alone(Part part) const { return parts_[part].is_alone; }
  /// The index jumps anywhere.
  bool refracts() const { return refracts_; }

  /// To the next collision or to the end of the part. rise: gradient of the logarithm of what light
  /// is worth, along which flights are stretched; or null.
  [[gnu::flatten]] LegEnd fly(Flight& flight, RandomStream& random,
                              const Vec3* rise = nullptr) const {
    const Vec3 x = flight.point.x, d = flight.direction;
    const auto path = [&](double s) -> Vec3 { return x + s * d; };
    auto [way, end] = regions_.way_out(flight.point, d);
    const Part part = flight.point.part;
    const PartMedium& in = medium(part);
    const double pull = rise && in.is_uniform() ? rise->dot(d) / in.mu_t() : 0;
    const double free = pull > 0 ? stretched(flight, in.mu_t(), pull, way, random)
                                 : in.free_path(path, way, random);
    if (free < way) {
      way = free;
      end = at_collision;
    }
    flight.point.x = path(way);
    flight.arc_length += way;
    flight.optical_path += (1 + excess(part)) * way;
    flight.optical_depth += in.reference() * way;
    if (!in.scatters()) attenuate(flight, flight.weight * in.transmitted(path, way, random));
    return end;
  }

  /// The part that begins where a leg has ended on the surface of a body.
  Part beyond(const Flight& flight, LegEnd surface) const {
    return regions_.beyond(flight.point.part, surface, flight.point.x, flight.direction);
  }
  /// At a surface that refracts: to the part beyond or back. The tangent, if not null, goes on too.
  struct Sides {
    IndexGradient here, beyond;
  };
  void cross(Flight& flight, LegEnd surface, Part to, const Sides& sides, RayTangent* tangent,
             RandomStream& random) const {
    RayState ray{flight.point.x, (1 + sides.here.excess) * flight.direction};
    const RayJump jump(regions_.surface(surface), ray, sides.here, sides.beyond);
    const double reflectance = jump.reflectance();
    const bool reflected = jump.is_total() || random.uniform() < reflectance;
    jump.pass(reflected, ray, tangent);
    flight.crosses_body = true;
    flight.is_joinable = flight.is_joinable && flight.passages.count < Passages::most;
    if (flight.is_joinable) flight.passages.add(reflected);
    const double chance = jump.chance(reflected);
    flight.fresnel *= chance;
    flight.hollows += jump.is_hollow();
    flight.optical_depth -= std::log(chance);
    flight.direction = ray.v.normalized();
    if (!reflected) flight.point.part = to;
  }
  /// The same where it does not.
  void pass(Flight& flight, Part to) const {
    flight.crosses_body = true;
    flight.point.part = to;
  }

  /// Along the straight line, where nothing on it refracts.
  std::optional<Join> join(const PathPoint& p, const PathPoint& q, RandomStream& random) const {
    if (!are_alike(p.part, q.part)) return std::nullopt;
    const Vec3 chord = q.x - p.x;
    const double square = chord.squaredNorm(), length = std::sqrt(square);
    if (!(length > 0)) return std::nullopt;
    const Vec3 d = chord / length;
    Join join{.start_direction = d,
              .end_direction = d,
              .spreading = square,
              .optical_path = (1 + excess(p.part)) * length};
    const auto pass = [&](Part part, double from, double to) {
      const auto path = [&](double s) -> Vec3 { return p.x + (from + s) * d; };
      join.optical_depth += medium(part).reference() * (to - from);
      join.transmittance *= medium(part).transmitted(path, to - from, random);
    };
    if (is_alone(p.part)) {
      if (is_blocked(p, d, length)) return std::nullopt;
      pass(p.part, 0, length);
    } else if (!for_each_part(p, d, length, pass)) {
      return std::nullopt;
    }
    return join;
  }

  /// The straight way of parallel light to a point.
  std::optional<BeamWay> way_to_beam(const PathPoint& p, const ParallelLight& light,
                                     RandomStream& random) const {
    const double length = (p.x - light.x).dot(light.direction);
    if (!(length > 0)) return std::nullopt;
    const PathPoint from{p.x - length * light.direction, p.part};
    const auto join = this->join(p, from, random);
    if (!join) return std::nullopt;
    return BeamWay{.start_direction = join->start_direction,
                   .place = from.x,
                   .thinning = 1,
                   .orientation = 1,
                   .arc_length = length,
                   .optical_path = join->optical_path,
                   .transmittance = join->transmittance,
                   .optical_depth = join->optical_depth};
  }

  /// Of the straight line between two points at the least, whether light goes it or not.
  double least_depth(const PathPoint& p, const PathPoint& q) const {
    const Vec3 chord = q.x - p.x;
    const double length = chord.norm();
    const bool in_one_part = p.part == q.part && p.part == regions_.parts() - 1;
    if (in_one_part) return medium(p.part).least_extinction() * length;
    double depth = 0;
    for_each_part<true>(p, chord / length, length, [&](Part part, double from, double to) {
      depth += medium(part).least_extinction() * (to - from);
    });
    return depth;
  }

  /// To where light cannot go on straight.
  double way_to_jump(const PathPoint& p, const Vec3& d) const {
    if (is_alone(p.part)) return regions_.way_out(p, d).length;
    double way = 0;
    for_each_part(p, d, no_way, [&](Part, double, double to) { way = to; });
    return way;
  }

 private:
  static double stretched(Flight& flight, double mu_t, double pull, double way,
                          RandomStream& random) {
    const StretchedFlight of(mu_t, pull);
    const double free = of.sample(random.uniform());
    flight.stretched = free < way ? of.weight(free) : of.weight_beyond(way);
    return free;
  }

  struct OfPart {
    PartMedium medium;
    std::optional<double> excess;
    Part first_alike;
    bool is_alone;
  };

  void add(const PartMedium& medium, std::optional<double> excess) {
    const Part part = static_cast<Part>(parts_.size());
    OfPart& added = parts_.emplace_back(OfPart{medium, excess, part, true});
    for (Part other = around; other < part; ++other) {
      OfPart& of = parts_[other];
      if (!excess || of.excess != excess) {
        refracts_ = true;
      } else {
        added.first_alike = std::min(added.first_alike, other);
        added.is_alone = of.is_alone = false;
      }
    }
  }

  /// Calls use(part, from, to) for the stretches of a straight line, through surfaces that do not
  /// refract, or through all. Returns whether the line goes on to its end.
  template <bool through_all = false, class Use>
  bool for_each_part(PathPoint at, const Vec3& d, double length, const Use& use) const {
    const double shorter = (1 - 1e-9) * length;  // the end may be on a surface itself
    const Vec3 start = at.x;
    double from = 0;
    for (int leg = 0; leg < regions_.most_legs(); ++leg) {
      const auto [way, end] = regions_.way_out(at, d);
      if (from + way >= shorter) {
        use(at.part, from, length);
        return true;
      }
      use(at.part, from, from + way);
      if (end == at_boundary) return false;
      from += way;
      const PathPoint next{start + from * d, regions_.beyond(at.part, end, start + from * d, d)};
      if (!through_all && !are_alike(at.part, next.part)) return false;
      at = next;
    }
    return false;
  }

  bool is_blocked(const PathPoint& p, const Vec3& d, double length) const {
    // The end may be on the surface itself.
    const double shorter = (1 - 1e-9) * length;
    const Room room = regions_.room(p.part);
    if (!is_convex(room.surfaces[0]) && way_out(room.surfaces[0], p.x, d) < shorter) return true;
    for (const Surface& hole : room.surfaces.subspan(1))
      if (way_in(hole, p.x, d) < shorter) return true;
    return false;
  }

  Regions regions_;
  std::vector<OfPart> parts_;
  bool refracts_ = false;
};

}  // namespace flatspeckle::grin
