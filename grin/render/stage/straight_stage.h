#pragma once

#include "grin/rays/marching/ray_jump.h"
#include "grin/render/stage/flight.h"
#include "grin/render/stage/part_medium.h"

namespace flatspeckle::grin {

/// Sets the weight of a flight after a segment in a part that absorbs without scattering.
inline void attenuate(Flight& flight, double weight) {
  if (flight.point.part != around) flight.absorbed_in_body += flight.weight - weight;
  flight.weight = weight;
}

/// A stage in which light propagates along straight lines within each part.
class StraightStage {
 public:
  /// field_excess: n - 1 of the part that the field fills; nullopt if it is not constant.
  StraightStage(const Stage& stage, std::optional<double> field_excess) : regions_(stage) {
    for (Part part = around; part < stage.parts(); ++part) {
      const PartMedium medium(stage.medium_in(part), mean_density(stage, part));
      if (part != stage.field_part())
        add(medium, stage.excess_in(part));
      else
        add(medium, field_excess);
      if (part != around && stage.bodies[part - 1].face == BodyFace::absorbs)
        parts_.back().reflectivity = 0;
    }
  }

  const Regions& regions() const { return regions_; }
  const PartMedium& medium(Part part) const { return parts_[part].medium; }
  /// Returns index - 1 of a part of constant index.
  double excess(Part part) const { return *parts_[part].excess; }

  /// Whether light crosses from one part into the other without refraction.
  bool are_alike(Part a, Part b) const { return parts_[a].first_alike == parts_[b].first_alike; }
  /// Whether the index of a part differs from that of every other part (are_alike).
  bool is_alone(Part part) const { return parts_[part].is_alone; }
  /// Fraction of totally reflected light that is not absorbed by an opaque body.
  double reflectivity(Part part) const { return parts_[part].reflectivity; }
  /// Whether the index jumps at some surface.
  bool refracts() const { return refracts_; }

  /// Advances a flight to its next collision or to the surface of its part. log_gradient: gradient
  /// of the logarithm of the importance, which biases the flight (exponential transform); or null.
  [[gnu::flatten]] SegmentEnd fly(Flight& flight, RandomStream& random,
                                  const Vec3* log_gradient = nullptr) const {
    const Vec3 x = flight.point.x, d = flight.direction;
    const auto path = [&](double s) -> Vec3 { return x + s * d; };
    const Part part = flight.point.part;
    const PartMedium& in = medium(part);
    const double growth_rate =
        log_gradient && in.is_uniform() ? log_gradient->dot(d) / in.mu_t() : 0;
    const bool is_usual = in.is_uniform() && !(growth_rate > 0);
    double distance = is_usual ? sample_free_flight(in.mu_t(), random.uniform()) : no_crossing;
    SegmentEnd end = at_collision;
    if (!(is_usual && distance < regions_.clearance(flight.point))) {
      const auto exit = regions_.exit_distance(flight.point, d);
      if (growth_rate > 0)
        distance = sample_biased(flight, in.mu_t(), growth_rate, exit.length, random);
      else if (!is_usual)
        distance = in.free_path(path, exit.length, random);
      if (!(distance < exit.length)) {
        distance = exit.length;
        end = exit.end;
      }
    }
    flight.point.x = path(distance);
    flight.arc_length += distance;
    flight.optical_path += (1 + excess(part)) * distance;
    flight.optical_depth += in.reference() * distance;
    if (!in.scatters()) attenuate(flight, flight.weight * in.transmitted(path, distance, random));
    return end;
  }

  /// Returns the part beyond the surface of a body on which a segment has ended.
  Part beyond(const Flight& flight, SegmentEnd surface) const {
    return regions_.beyond(flight.point.part, surface, flight.point.x, flight.direction);
  }
  /// Index and its gradient at a surface: on the side of the arriving flight, and on the other
  /// side.
  struct Sides {
    IndexGradient here, beyond;
  };
  /// Refracts or reflects a flight at a surface with an index jump, and its tangent if not null.
  void cross(Flight& flight, SegmentEnd surface, Part to, const Sides& sides, RayTangent* tangent,
             RandomStream& random) const {
    RayState ray{flight.point.x, (1 + sides.here.excess) * flight.direction};
    const RayJump jump(regions_.surface(surface), ray, sides.here, sides.beyond);
    const double reflectance = jump.reflectance();
    const bool reflected = jump.is_total() || random.uniform() < reflectance;
    jump.pass(reflected, ray, tangent);
    flight.crosses_body = true;
    flight.is_connectable =
        flight.is_connectable && flight.crossings.count < InterfaceCrossings::most;
    if (flight.is_connectable) flight.crossings.add(reflected);
    const double probability = jump.probability(reflected);
    flight.fresnel *= probability;
    flight.concave_crossings += jump.has_concave_parts();
    flight.optical_depth -= std::log(probability);
    flight.direction = ray.v.normalized();
    if (!reflected) flight.point.part = to;
    const double absorbed = (1 - reflectivity(to)) * flight.weight;
    flight.absorbed_in_body += absorbed;
    flight.weight -= absorbed;
  }
  /// Takes a flight through a surface without an index jump into part `to`.
  void pass(Flight& flight, Part to) const {
    flight.crosses_body = true;
    flight.point.part = to;
  }

  /// Connects two points by the straight line if no surface on it refracts.
  std::optional<TestConnection> connect(const PathPoint& p, const PathPoint& q,
                                        RandomStream& random) const {
    if (!are_alike(p.part, q.part)) return std::nullopt;
    const Vec3 chord = q.x - p.x;
    const double square = chord.squaredNorm(), length = std::sqrt(square);
    if (!(length > 0)) return std::nullopt;
    const Vec3 d = chord / length;
    TestConnection connection{.start_direction = d,
                              .end_direction = d,
                              .spreading = square,
                              .optical_path = (1 + excess(p.part)) * length};
    const auto pass = [&](Part part, double from, double to) {
      const auto path = [&](double s) -> Vec3 { return p.x + (from + s) * d; };
      connection.optical_depth += medium(part).reference() * (to - from);
      connection.transmittance *= medium(part).transmitted(path, to - from, random);
    };
    if (is_alone(p.part)) {
      if (is_blocked(p, d, length)) return std::nullopt;
      pass(p.part, 0, length);
    } else if (!for_each_part(p, d, length, pass)) {
      return std::nullopt;
    }
    return connection;
  }

  /// Connects a point to parallel light by the straight line.
  std::optional<BeamConnection> connection_to_beam(const PathPoint& p, const ParallelLight& light,
                                                   RandomStream& random) const {
    const double length = (p.x - light.x).dot(light.direction);
    if (!(length > 0)) return std::nullopt;
    const PathPoint from{p.x - length * light.direction, p.part};
    const auto connection = this->connect(p, from, random);
    if (!connection) return std::nullopt;
    return BeamConnection{.start_direction = connection->start_direction,
                          .place = from.x,
                          .thinning = 1,
                          .orientation = 1,
                          .arc_length = length,
                          .optical_path = connection->optical_path,
                          .transmittance = connection->transmittance,
                          .optical_depth = connection->optical_depth};
  }

  /// Lower bound of the optical depth of the straight line between two points, whether or not light
  /// can follow it.
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

  /// Distance to the first index jump, or to the boundary.
  double distance_to_jump(const PathPoint& p, const Vec3& d) const {
    if (is_alone(p.part)) return regions_.exit_distance(p, d).length;
    double distance = 0;
    for_each_part(p, d, no_crossing, [&](Part, double, double to) { distance = to; });
    return distance;
  }

 private:
  static double sample_biased(Flight& flight, double mu_t, double growth_rate, double distance,
                              RandomStream& random) {
    const BiasedFlight of(mu_t, growth_rate);
    const double free = of.sample(random.uniform());
    flight.bias_weight = free < distance ? of.weight(free) : of.weight_beyond(distance);
    return free;
  }

  struct OfPart {
    PartMedium medium;
    std::optional<double> excess;
    Part first_alike;
    bool is_alone;
    double reflectivity = 1;
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

  /// Calls use(part, from, to) for the interval of a straight line in each part. The line ends
  /// early at the boundary and, unless through_all, at a surface that refracts. Returns whether it
  /// reaches its full length.
  template <bool through_all = false, class Use>
  bool for_each_part(PathPoint at, const Vec3& d, double length, const Use& use) const {
    const double shorter = (1 - 1e-9) * length;  // the end may be on a surface itself
    const Vec3 start = at.x;
    double from = 0;
    for (int segment = 0; segment < regions_.most_segments(); ++segment) {
      const auto [distance, end] = regions_.exit_distance(at, d);
      if (from + distance >= shorter) {
        use(at.part, from, length);
        return true;
      }
      use(at.part, from, from + distance);
      if (end == at_boundary) return false;
      from += distance;
      const PathPoint next{start + from * d, regions_.beyond(at.part, end, start + from * d, d)};
      if (!through_all && !are_alike(at.part, next.part)) return false;
      at = next;
    }
    return false;
  }

  bool is_blocked(const PathPoint& p, const Vec3& d, double length) const {
    // The end may be on the surface itself.
    const double shorter = (1 - 1e-9) * length;
    const SurfaceRegion region = regions_.region(p.part);
    if (!is_convex(region.surfaces[0]) && exit_distance(region.surfaces[0], p.x, d) < shorter)
      return true;
    for (const Surface& hole : region.surfaces.subspan(1))
      if (entry_distance(hole, p.x, d) < shorter) return true;
    return false;
  }

  Regions regions_;
  std::vector<OfPart> parts_;
  bool refracts_ = false;
};

}  // namespace flatspeckle::grin
