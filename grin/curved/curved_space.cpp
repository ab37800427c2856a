#include "grin/curved/curved_space.h"

#include <algorithm>
#include <cmath>

#include "grin/connections/geometric_spreading.h"
#include "grin/straight/straight_legs.h"
#include "grin/surfaces/first_crossing.h"
#include "grin/ways/beam_search.h"
#include "grin/ways/way_search.h"

namespace flatspeckle::grin {

std::unique_ptr<const RayField> make_ray_field(const AnyIndexField& field,
                                               std::span<const Surface> room, bool leapfrogs) {
  constexpr decltype(&make_ray_field) in_file[ray_field_files] = {ray_field_in<0>, ray_field_in<1>,
                                                                  ray_field_in<2>};
  return in_file[field.index() % ray_field_files](field, room, leapfrogs);
}

namespace {

/// Of all the part that it fills.
std::optional<double> excess_of(const AnyIndexField& field) {
  const auto* homogeneous = std::get_if<Homogeneous>(&field);
  return homogeneous ? std::optional(homogeneous->n_excess) : std::nullopt;
}

/// Inside of the first surface and outside of all others.
std::vector<double> sides_of_room(const Stage& stage) {
  std::vector<double> sides(stage.parts() - stage.field_part(), -1);
  sides.front() = 1;
  return sides;
}

}  // namespace

CurvedSpace::CurvedSpace(const AnyIndexField& field, const Stage& stage,
                         const CurvedSpaceOptions& options)
    : setup_(std::make_shared<const Setup>(
          Setup{.stage = StraightStage<RenderPlan{}>(stage, excess_of(field)),
                .field_part = stage.field_part(),
                .is_straight = excess_of(field).has_value(),
                .sides = sides_of_room(stage),
                .options = options,
                .connection = {.step = options.step,
                               .max_length = options.max_length,
                               .start = {.chord_share = 0.2},
                               .tolerance = 1e-8,
                               .carry = 3e-7,
                               .count_caustics = false}})),
      field_(make_ray_field(field, room().surfaces, options.leapfrogs)) {}

std::unique_ptr<const CurvedSpace> CurvedSpace::frozen(double phase) const {
  return std::unique_ptr<const CurvedSpace>(new CurvedSpace(setup_, field_->frozen(phase)));
}

/// How the rays beside a flight go.
struct CurvedSpace::Neighbours {
  bool wanted;
  bool bent = false;  ///< by the field or at the surface of a body
  double n_start = 0;
  RayTangent tangent = {};
};

Flight CurvedSpace::fly(const PathPoint& from, const Vec3& direction, RandomStream& random,
                        FlightLog* log) const {
  const Spreading spreading = setup_->options.spreading;
  if (spreading != Spreading::to_boundary || log)
    return fly(from, direction, spreading != Spreading::none, random, log);
  RandomStream again = random;
  const Flight flight = fly(from, direction, false, random, log);
  return flight.end == Flight::End::boundary ? fly(from, direction, true, again, log) : flight;
}

Flight CurvedSpace::fly(const PathPoint& from, const Vec3& direction, bool spreads,
                        RandomStream& random, FlightLog* log) const {
  Flight flight{.point = from, .start_direction = direction, .direction = direction};
  Neighbours neighbours{spreads};
  const double longest =
      setup_->is_straight ? std::numeric_limits<double>::infinity() : setup_->options.max_length;
  for (int legs = 0; legs < setup_->stage.regions().most_legs() && flight.arc_length <= longest;
       ++legs) {
    FlightLeg now{flight.point, flight.direction, flight.arc_length, flight.weight};
    const auto end = leg(flight, neighbours, random);
    if (!end) return flight;
    if (log) {
      now.length = flight.arc_length - now.length;
      log->push_back(now);
    }
    if (*end > at_boundary) {
      cross(flight, *end, neighbours, random);
      continue;
    }
    if (flight.arc_length > longest) return flight;
    flight.end = *end == at_collision ? Flight::End::collision : Flight::End::boundary;
    if (!flight.is_joinable) return flight;
    if (!neighbours.bent)
      flight.spreading = flight.arc_length * flight.arc_length;
    else if (neighbours.wanted)
      flight.spreading = std::abs(
          signed_spreading(neighbours.tangent, neighbours.n_start, direction, flight.direction));
    return flight;
  }
  return flight;
}

/// Nothing: lost.
std::optional<LegEnd> CurvedSpace::leg(Flight& flight, Neighbours& neighbours,
                                       RandomStream& random) const {
  if (is_curved(flight.point.part)) return curved_leg(flight, neighbours, random);
  const double before = flight.arc_length, n = index(flight.point);
  const LegEnd end = setup_->stage.fly(flight, random);
  if (before == 0) neighbours.n_start = n;
  if (neighbours.bent)
    neighbours.tangent.dx += (flight.arc_length - before) / n * neighbours.tangent.dv;
  return end;
}

std::optional<LegEnd> CurvedSpace::curved_leg(Flight& flight, Neighbours& neighbours,
                                              RandomStream& random) const {
  RayState ray = start_ray(*field_, flight.point.x, flight.direction);
  if (flight.arc_length == 0) neighbours.n_start = ray.v.norm();
  neighbours.bent = true;
  const double longest = setup_->options.max_length - flight.arc_length;
  const bool follows = neighbours.wanted && flight.is_joinable;
  double weight = flight.weight;
  const LegStop stop = field_->fly(leg_room(), longest, weight, random, ray,
                                   follows ? &neighbours.tangent : nullptr);
  if (stop == LegStop::lost) return std::nullopt;
  end_leg(flight, ray, weight);
  return stop == LegStop::collision ? at_collision : end_at(ray.x);
}

void CurvedSpace::end_leg(Flight& flight, const RayState& ray, double weight) const {
  if (!medium().scatters() && !medium().grid())
    weight *= transmittance(medium().mu_t(), ray.arc_length);
  attenuate(flight, weight);
  flight.point.x = ray.x;
  flight.direction = ray.v.normalized();
  flight.arc_length += ray.arc_length;
  flight.optical_path += ray.optical_path;
  flight.optical_depth += medium().reference() * ray.arc_length;
}

void CurvedSpace::cross(Flight& flight, LegEnd surface, Neighbours& neighbours,
                        RandomStream& random) const {
  const Part from = flight.point.part, to = setup_->stage.beyond(flight, surface);
  if (setup_->stage.are_alike(from, to)) return setup_->stage.pass(flight, to);
  if (!neighbours.bent) {
    neighbours.bent = true;
    neighbours.tangent.dx.diagonal().fill(flight.arc_length / neighbours.n_start);
  }
  setup_->stage.cross(flight, surface, to, {side(from, flight.point.x), side(to, flight.point.x)},
                      neighbours.wanted ? &neighbours.tangent : nullptr, random);
}

/// Without collisions, for searches (straight_legs.h).
class CurvedSpace::Legs {
 public:
  explicit Legs(const CurvedSpace& space) : space_(space), straight_(space.setup_->stage) {}

  const Regions& regions() const { return straight_.regions(); }
  bool are_alike(Part a, Part b) const { return straight_.are_alike(a, b); }
  bool is_alone(Part part) const { return straight_.is_alone(part); }
  double index(const PathPoint& p) const { return space_.index(p); }
  RayState start(const PathPoint& p, const Vec3& direction) const {
    return {p.x, index(p) * direction};
  }

  std::optional<Meeting> to_surface(Part part, RayState& ray, RayTangent* tangent,
                                    RandomStream& random) const {
    if (!space_.is_curved(part)) return straight_.to_surface(part, ray, tangent, random);
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
  int steps(Part part, double sigma) const {
    if (!space_.is_curved(part)) return 1;
    return static_cast<int>(std::clamp(std::ceil(sigma / step()), 1.0, 1e5));
  }
  void advance(Part part, double sigma, int steps, RayState& ray, RayTangent* tangent) const {
    if (!space_.is_curved(part)) return straight_.advance(part, sigma, steps, ray, tangent);
    space_.field_->advance(sigma, steps, ray, tangent);
  }
  bool stays(Part part, const RayState& start, double sigma) const {
    if (!space_.is_curved(part)) return straight_.stays(part, start, sigma);
    return space_.stays_inside(start, sigma, steps(part, sigma));
  }
  template <class Offer>
  void approach(Part part, RayState ray, const Vec3& x, const Offer& offer) const {
    if (!space_.is_curved(part)) return straight_.approach(part, ray, x, offer);
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
  PlaneCrossing to_plane(Part part, const ParallelLight& light, RayState& ray,
                         RayTangent* tangent) const {
    if (!space_.is_curved(part)) return straight_.to_plane(part, light, ray, tangent);
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
  RayJump jump(Part from, const Meeting& at, const RayState& ray) const {
    return RayJump(regions().surface(at.surface), ray, space_.side(from, ray.x),
                   space_.side(at.beyond, ray.x));
  }

  double extinction(Part part) const { return straight_.extinction(part); }
  double reference(Part part) const { return straight_.reference(part); }
  double transmitted(Part part, const RayState& start, double length, RandomStream& random) const {
    if (!space_.is_curved(part)) return straight_.transmitted(part, start, length, random);
    const PartMedium& medium = space_.medium();
    if (!medium.grid()) return transmittance(medium.mu_t(), length);
    return space_.field_->ratio_tracked(space_.leg_room(), start, length, random);
  }

 private:
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

  const CurvedSpace& space_;
  StraightLegs<RenderPlan{}> straight_;
};

std::optional<Join> CurvedSpace::join_through(const PathPoint& p, const PathPoint& q,
                                              RandomStream& random,
                                              ConnectionStatistics& statistics) const {
  if (!joins_through()) return std::nullopt;
  return join_by_way(Legs(*this), p, q, search(), random, statistics);
}

/// Of ways that are refracted, or to a beam.
ConnectionOptions CurvedSpace::search() const {
  ConnectionOptions options = setup_->connection;
  options.max_iterations = 20;
  if (setup_->is_straight) options.max_length = std::numeric_limits<double>::infinity();
  return options;
}

std::vector<BeamWay> CurvedSpace::ways_to_beam(const PathPoint& p, const ParallelLight& light,
                                               std::span<const BeamSeed> seeds,
                                               RandomStream& random,
                                               ConnectionStatistics& statistics) const {
  if (searches_for_beams()) {
    const Legs legs(*this);
    const ConnectionOptions options = search();
    return BeamSearch(legs, p, light, options).find(seeds, random, statistics);
  }
  if (const auto way = plainest_way_to_beam(p, light, random, statistics)) return {*way};
  return {};
}

std::optional<BeamWay> CurvedSpace::plainest_way_to_beam(const PathPoint& p,
                                                         const ParallelLight& light,
                                                         RandomStream& random,
                                                         ConnectionStatistics& statistics) const {
  if (searches_for_beams()) {
    const Legs legs(*this);
    const ConnectionOptions options = search();
    return BeamSearch(legs, p, light, options).find_plainest(random, statistics);
  }
  if (is_curved(p.part)) return std::nullopt;
  return setup_->stage.way_to_beam(p, light, random);
}

std::optional<BeamWay> CurvedSpace::some_way_to_beam(const PathPoint& p, const ParallelLight& light,
                                                     RandomStream& random,
                                                     ConnectionStatistics& statistics) const {
  if (!searches_for_beams()) return std::nullopt;
  const Legs legs(*this);
  const ConnectionOptions options = search();
  return BeamSearch(legs, p, light, options).find_one(random, statistics);
}

std::optional<BeamWay> CurvedSpace::beam_way(const PathPoint& p, const ParallelLight& light,
                                             const Vec3& direction, const Passages& passages,
                                             RandomStream& random) const {
  const Legs legs(*this);
  const ConnectionOptions options = search();
  return BeamSearch(legs, p, light, options).along(direction, passages, random);
}

std::optional<Join> CurvedSpace::join(const PathPoint& p, const PathPoint& q, RandomStream& random,
                                      ConnectionStatistics& statistics) const {
  if (!is_curved(p.part)) return setup_->stage.join(p, q, random);
  if (p.part != q.part) return std::nullopt;
  const double slack = 1e-7 * ((q.x - p.x).norm() + setup_->options.step);  // ends on the surface
  const CurveEnds ends{p.x, q.x, {room().surfaces, setup_->sides, slack}};
  const ConnectionEstimate estimate = field_->connect(ends, setup_->connection, random, statistics);
  if (!estimate.curve) return std::nullopt;
  const Connection& curve = *estimate.curve;
  if (goes_outside(p.x, curve.start_direction) || goes_outside(q.x, -curve.end_direction))
    return std::nullopt;
  return Join{.start_direction = curve.start_direction,
              .end_direction = curve.end_direction,
              .spreading = curve.spreading,
              .optical_path = curve.optical_path,
              .optical_depth = medium().reference() * curve.arc_length,
              .transmittance = transmitted(p, curve, random),
              .multiplicity = estimate.multiplicity};
}

/// On so many steps and between their ends, which are all that searches ask about.
bool CurvedSpace::stays_inside(RayState ray, double sigma, int steps) const {
  const double h = sigma / steps, slack = 1e-7 * (sigma + h);  // ends may be on the surface
  for (int i = 0; i < steps; ++i) {
    const RayState before = ray;
    field_->advance(h, 1, ray, nullptr);
    const StepCurve curve(before, ray, h);
    const auto depth = [&](double theta) { return slack - room().distance(curve.x(theta)); };
    const double arc = 1.1 * (ray.arc_length - before.arc_length);
    if (first_change(depth, {0, 1, depth(0), depth(1)}, arc)) return false;
  }
  return true;
}

/// From a point on the surface.
bool CurvedSpace::goes_outside(const Vec3& x, const Vec3& direction) const {
  const double on_surface = 1e-9 * setup_->options.step;
  return room().distance(x) >= -on_surface && direction.dot(room().normal(x)) > 0;
}

double CurvedSpace::transmitted(const PathPoint& p, const Connection& curve,
                                RandomStream& random) const {
  if (!medium().grid()) return transmittance(medium().mu_t(), curve.arc_length);
  return field_->ratio_tracked(leg_room(), start_ray(*field_, p.x, curve.start_direction),
                               curve.sigma, curve.steps, random);
}

std::unique_ptr<const CurvedSpace> make_curved_space(const AnyIndexField& field, const Stage& stage,
                                                     const CurvedSpaceOptions& options) {
  check(stage);
  return std::make_unique<CurvedSpace>(field, stage, options);
}

}  // namespace flatspeckle::grin
