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

/// The surface of a body that a ray meets, and the part beyond the surface.
struct Meeting {
  SegmentEnd surface;
  Part beyond;
};

/// Crossing of a ray segment with the plane of parallel light.
struct PlaneCrossing {
  bool is_reached = false;  ///< whether the ray reaches the plane when it continues forwards
  double sigma = 0;         ///< ray parameter from the start of the segment to the plane
};

/// Ray segments for specular connection searches, without collisions. They start at a point in a
/// part or on its surface. A RayTangent, if not null, is advanced with its ray.
class Segments {
 public:
  /// Holds a reference to the space.
  explicit Segments(const Space& space) : space_(space), stage_(space.setup_->stage) {}

  const Regions& regions() const { return stage_.regions(); }
  bool are_alike(Part a, Part b) const { return stage_.are_alike(a, b); }
  bool is_alone(Part part) const { return stage_.is_alone(part); }
  double index(const PathPoint& p) const { return space_.index(p); }
  RayState start(const PathPoint& p, const Vec3& direction) const {
    return {p.x, index(p) * direction};
  }

  /// Advances to the surface of a body; returns nullopt if the segment does not end on one.
  std::optional<Meeting> to_surface(Part part, RayState& ray, RayTangent* tangent,
                                    RandomStream& random) const {
    if (space_.is_curved(part)) return curved_to_surface(part, ray, tangent, random);
    const double n = ray.v.norm();
    const Vec3 d = ray.v / n;
    const auto [distance, end] = regions().exit_distance({ray.x, part}, d);
    if (end == at_boundary) return std::nullopt;
    advance_straight(distance / n, ray, tangent);
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
  /// Whether the last segment of a path, up to `sigma`, meets no index jump and does not leave the
  /// stage.
  bool stays(Part part, const RayState& start, double sigma) const {
    if (space_.is_curved(part)) return space_.stays_inside(start, sigma, steps(part, sigma));
    const double n = start.v.norm();
    return stage_.distance_to_jump({start.x, part}, start.v / n) >= (1 - 1e-9) * sigma * n;
  }
  /// Calls offer(sigma, squared distance) for each point where a segment comes closest to x.
  template <class Offer>
  void approach(Part part, const RayState& ray, const Vec3& x, const Offer& offer) const {
    if (space_.is_curved(part)) return curved_approach(ray, x, offer);
    const double n = ray.v.norm();
    const double distance = stage_.distance_to_jump({ray.x, part}, ray.v / n);
    const double sigma = std::min((x - ray.x).dot(ray.v) / (n * n), distance / n);
    if (sigma > 0) offer(sigma, (ray.x + sigma * ray.v - x).squaredNorm());
  }
  /// Advances ray and tangent to the plane of parallel light; a straight ray that moves away from
  /// the plane is extended backwards.
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

  double reflectivity(Part part) const { return stage_.reflectivity(part); }
  double extinction(Part part) const { return stage_.medium(part).mu_t(); }
  double reference(Part part) const { return stage_.medium(part).reference(); }
  double transmitted(Part part, const RayState& start, double length, RandomStream& random) const {
    const PartMedium& medium = stage_.medium(part);
    if (space_.is_curved(part)) {
      if (!medium.varies()) return transmittance(medium.mu_t(), length);
      return space_.field_->ratio_tracked(space_.segment_domain(), start, length, random);
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
    if (!space_.connects_through()) return std::nullopt;
    static const PartMedium clear;
    double all = 1;
    const SegmentDomain domain{space_.region(), clear, step()};
    if (space_.field_->fly(domain, longest(), all, random, ray, tangent) != SegmentStop::surface)
      return std::nullopt;
    const SegmentEnd end = space_.end_on_surface(ray);
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
      const bool is_out = space_.region().distance(ray.x) > 0;
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
        return {space_.region().distance(ray.x) <= 1e-6 * step(), i * step() + sigma};
      }
      if (space_.region().distance(ray.x) > 0) return {};
    }
    return {};
  }
  /// Returns the ray parameter from a state before the plane of the light to the plane, by the
  /// secant method. to: the state one step later, which is beyond the plane.
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
  /// Changes the derivatives in `tangent` from those at a fixed ray parameter sigma (C23) to
  /// those of the points at which neighbouring rays meet the plane.
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

/// Sampling strategy of random rays at interfaces.
enum class Seek {
  strongest,    ///< rays are reflected with the Fresnel reflectance as probability
  reflections,  ///< faint reflections, and paths with many of them, are sampled more often
};

/// Rays without collisions that start at a point and are refracted or reflected at surfaces of
/// bodies, for specular connection searches. A segment extends from one interface crossing to the
/// next, through surfaces where the index does not jump.
class CrossingWalk {
 public:
  /// Holds a reference to the segments.
  CrossingWalk(const Segments& segments, const PathPoint& from, Seek seek)
      : segments_(segments), from_(from), seeks_reflections_(seek == Seek::reflections) {
    aim_at_bodies();
  }

  /// Samples a start direction. From outside of all bodies it aims at one of them. From inside a
  /// body it aims at a body inside that one, or is sampled from the distribution `start` about
  /// `chord`, the straight direction to the target. Seek::reflections favours directions near the
  /// rim of a body, where paths with many reflections start.
  Vec3 start_direction(const Vec3& chord, const StartDirections& start,
                       RandomStream& random) const {
    if (cones_.empty() || (!is_outside_ && random.uniform() < 0.5))
      return start.sample(chord, random);
    const Cone& cone = cones_[pick(random)];
    const double u = random.uniform();
    const double inside = seeks_reflections_ && random.uniform() < 0.5 ? 1 - u * u * u : u;
    return random_turn(cone.axis, cone.one_minus_cosine * inside, random);
  }

  /// Whether rays start outside of all bodies, towards one of them.
  bool aims_at_bodies() const { return is_outside_; }

  /// Start of a ray's last segment.
  struct Head {
    Part part;
    RayState ray;
    double probability = 1;         ///< Fresnel probability of the crossings so far
    int concave_crossings = 0;      ///< number of crossings at surfaces with concave parts
    Vec3 first_met = Vec3::Zero();  ///< position of the first refraction or reflection
  };
  /// Follows a ray through the given crossings, and its tangent if not null. Returns nullopt if the
  /// ray does not have these crossings.
  std::optional<Head> follow(const Vec3& direction, const InterfaceCrossings& crossings,
                             RayTangent* tangent, RandomStream& random) const {
    Head head{from_.part, segments_.start(from_, direction)};
    for (int i = 0; i < crossings.count; ++i) {
      const auto met =
          to_jump(head.part, head.ray, tangent, random, [](Part, const RayState&, double) {});
      if (!met) return std::nullopt;
      if (i == 0) head.first_met = head.ray.x;
      const RayJump jump = segments_.jump(head.part, *met, head.ray);
      const bool reflects = crossings.reflects(i);
      head.probability *= jump.probability(reflects) * segments_.reflectivity(met->beyond);
      head.concave_crossings += jump.has_concave_parts();
      if (!(head.probability > 0)) return std::nullopt;
      jump.pass(reflects, head.ray, tangent);
      if (!reflects) head.part = met->beyond;
    }
    return head;
  }

  /// Follows a ray that is refracted wherever possible, else reflected. Calls at_segment(crossings
  /// so far, part, ray) at the start of each segment.
  template <class AtSegment>
  void refracted(const Vec3& direction, RandomStream& random, const AtSegment& at_segment) const {
    walk(direction, random, at_segment,
         [](const Head&, const InterfaceCrossings&, const Jump& jump,
            double) -> std::optional<bool> { return jump.of_ray.is_total(); });
  }
  /// Follows a ray that is refracted or reflected at random; with Seek::reflections both the
  /// refracted and the reflected segment are passed to at_segment.
  template <class AtSegment>
  void at_random(const Vec3& direction, RandomStream& random, const AtSegment& at_segment) const {
    walk(direction, random, at_segment,
         [&](const Head& head, const InterfaceCrossings& met, const Jump& jump,
             double depth) -> std::optional<bool> {
           const bool goes_on = met.count < free_crossings || random.uniform() < std::exp(-depth);
           if (!goes_on) return std::nullopt;
           const double probability = reflection_probability(jump.of_ray.reflectance());
           const bool reflects = random.uniform() < probability;
           if (seeks_reflections_ && probability >= faintest && !jump.of_ray.is_total())
             step(!reflects, jump, head, met, at_segment);
           return reflects;
         });
  }

  /// Calls use(part, start, arc length) for the interval of a path in each part. arc_length: arc
  /// length of the whole path.
  template <class Use>
  void for_each_segment(const Vec3& direction, const InterfaceCrossings& crossings,
                        double arc_length, RandomStream& random, const Use& use) const {
    RayState ray = segments_.start(from_, direction);
    Part part = from_.part;
    for (int i = 0; i < crossings.count; ++i) {
      const auto met = to_jump(part, ray, nullptr, random, use);
      if (!met) return;
      const bool reflects = crossings.reflects(i);
      segments_.jump(part, *met, ray).pass(reflects, ray);
      if (!reflects) part = met->beyond;
    }
    last_segment(part, ray, arc_length, random, use);
  }

 private:
  // number of crossings after which a ray undergoes Russian roulette at each further crossing, with
  // the transmittance of the segment before it as the probability to continue
  static constexpr int free_crossings = 3;
  static constexpr double faintest = 1e-6;  // reflectance below which an index jump is negligible

  /// Cone of directions that contains a body.
  struct Cone {
    Vec3 axis;
    double one_minus_cosine;
  };
  void aim_at_bodies() {
    const Regions& regions = segments_.regions();
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

  /// Advances to the next surface of a body with an index jump; calls use(part, start, arc length)
  /// for each interval of the ray up to that surface, one in each part.
  template <class Use>
  std::optional<Meeting> to_jump(Part& part, RayState& ray, RayTangent* tangent,
                                 RandomStream& random, const Use& use) const {
    for (int interval = 0; interval < segments_.regions().most_segments(); ++interval) {
      const RayState start = ray;
      const auto met = segments_.to_surface(part, ray, tangent, random);
      if (!met) return std::nullopt;
      use(part, start, ray.arc_length - start.arc_length);
      if (!segments_.are_alike(part, met->beyond)) return met;
      part = met->beyond;
    }
    return std::nullopt;
  }
  /// Follows the last segment until the path has this arc length, and calls use() as to_jump()
  /// does.
  template <class Use>
  void last_segment(Part part, RayState ray, double arc_length, RandomStream& random,
                    const Use& use) const {
    for (int interval = 0;
         interval < segments_.regions().most_segments() && !segments_.is_alone(part); ++interval) {
      const RayState start = ray;
      const auto met = segments_.to_surface(part, ray, nullptr, random);
      if (!met || ray.arc_length >= arc_length || !segments_.are_alike(part, met->beyond))
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
  /// Follows a ray; decide(head, crossings, jump, optical depth of the segment) returns whether the
  /// ray is reflected, or nullopt to end it.
  template <class AtSegment, class Decide>
  void walk(const Vec3& direction, RandomStream& random, const AtSegment& at_segment,
            const Decide& decide) const {
    Head head{from_.part, segments_.start(from_, direction)};
    InterfaceCrossings met;
    at_segment(met, head.part, head.ray);
    while (met.count < InterfaceCrossings::most) {
      double depth = 0;
      const auto pass = [&](Part part, const RayState&, double length) {
        depth += segments_.extinction(part) * length;
      };
      const auto at = to_jump(head.part, head.ray, nullptr, random, pass);
      if (!at) return;
      const Jump jump{segments_.jump(head.part, *at, head.ray), at->beyond};
      const auto reflects = decide(head, met, jump, depth);
      if (!reflects) return;
      std::tie(head, met) = step(*reflects, jump, head, met, at_segment);
    }
  }
  /// Refracts or reflects the ray at a surface; returns the start of the next segment, and the
  /// crossings so far.
  template <class AtSegment>
  static std::pair<Head, InterfaceCrossings> step(bool reflects, const Jump& jump, Head head,
                                                  InterfaceCrossings met,
                                                  const AtSegment& at_segment) {
    met.add(reflects);
    jump.of_ray.pass(reflects, head.ray);
    if (!reflects) head.part = jump.beyond;
    at_segment(met, head.part, head.ray);
    return {head, met};
  }
  /// Returns the sampling probability of a reflection. It is raised for faint reflections, except
  /// at negligible index jumps.
  double reflection_probability(double reflectance) const {
    if (reflectance < faintest || reflectance >= 1) return reflectance;
    return std::clamp(seeks_reflections_ ? std::sqrt(reflectance) : reflectance, 0.1, 0.9);
  }

  const Segments& segments_;
  PathPoint from_;
  bool seeks_reflections_;
  bool is_outside_ = false;
  std::vector<Cone> cones_;
};

}  // namespace flatspeckle::grin
