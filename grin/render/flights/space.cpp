#include "grin/render/flights/space.h"

#include <algorithm>
#include <cmath>

#include "grin/rays/connections/geometric_spreading.h"
#include "grin/rays/marching/watch.h"
#include "grin/rays/surfaces/first_crossing.h"

namespace flatspeckle::grin {

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

/// Of curves of the field.
ConnectionOptions curve_options(const SpaceOptions& options) {
  return {.step = options.step,
          .max_length = options.max_length,
          .start = {.chord_share = 0.2},
          .tolerance = 1e-8,
          .carry = 3e-7,
          .count_caustics = false};
}
/// Of ways that are refracted, or to a beam.
ConnectionOptions search_options(const SpaceOptions& options, bool is_straight) {
  ConnectionOptions search = curve_options(options);
  if (is_straight)
    search = {.step = 1,
              .max_length = std::numeric_limits<double>::infinity(),
              .start = {.chord_share = 0.3}};
  search.max_iterations = 20;
  return search;
}

}  // namespace

Space::Space(const AnyIndexField& field, const Stage& stage, const SpaceOptions& options)
    : setup_(std::make_shared<const Setup>(
          Setup{.stage = StraightStage(stage, excess_of(field)),
                .field_part = stage.field_part(),
                .is_straight = excess_of(field).has_value(),
                .sides = sides_of_room(stage),
                .options = options,
                .longest =
                    excess_of(field) ? std::numeric_limits<double>::infinity() : options.max_length,
                .connection = curve_options(options),
                .search = search_options(options, excess_of(field).has_value())})),
      field_(make_ray_field(field, room().surfaces, options.leapfrogs)) {}

std::unique_ptr<const Space> Space::frozen(double phase) const {
  return std::unique_ptr<const Space>(new Space(setup_, field_->frozen(phase)));
}

/// How the rays beside a flight go.
struct Space::Neighbours {
  bool wanted;
  bool bent = false;  ///< by the field or at the surface of a body
  double n_start = 0;
  RayTangent tangent = {};
};

namespace {

/// Adds to a log what becomes of a flight on its next leg.
class LoggedLeg {
 public:
  LoggedLeg(FlightLog* log, const Flight& flight) : log_(log), flight_(flight) {
    if (log) log->push_back({flight.point, flight.direction, flight.arc_length, flight.weight});
  }
  void end() const {
    if (log_) log_->back().length = flight_.arc_length - log_->back().length;
  }
  void drop() const {
    if (log_) log_->pop_back();
  }

 private:
  FlightLog* log_;
  const Flight& flight_;
};

}  // namespace

/// The last flight of a path a second time, as |J| costs more than that where many come before it.
Flight Space::fly_again_to_boundary(const PathPoint& from, const Vec3& direction,
                                    RandomStream& random, const Vec3* rise) const {
  RandomStream again = random;
  const Flight flight = fly_once(from, direction, false, random, nullptr, rise);
  if (flight.end != Flight::End::boundary) return flight;
  return fly_once(from, direction, true, again, nullptr, rise);
}

Flight Space::fly_once(const PathPoint& from, const Vec3& direction, bool spreads,
                       RandomStream& random, FlightLog* log, const Vec3* rise) const {
  Flight flight{.point = from, .start_direction = direction, .direction = direction};
  if (is_curved(from.part)) {
    go_on(flight, std::nullopt, spreads, random, log);
    return flight;
  }
  const LoggedLeg logged(log, flight);
  const LegEnd end = setup_->stage.fly(flight, random, rise);
  logged.end();
  if (end > at_boundary) {
    go_on(flight, end, spreads, random, log);
  } else if (flight.arc_length <= setup_->longest) {
    flight.end = end == at_collision ? Flight::End::collision : Flight::End::boundary;
    flight.spreading = flight.arc_length * flight.arc_length;
  }
  return flight;
}

/// end: of its first leg, on the surface of a body; nothing before that.
void Space::go_on(Flight& flight, std::optional<LegEnd> end, bool spreads, RandomStream& random,
                  FlightLog* log) const {
  Neighbours neighbours{spreads};
  int legs = 0;
  if (end) {
    neighbours.n_start = index(flight.point);
    cross(flight, *end, neighbours, random);
    ++legs;
  }
  for (; legs < setup_->stage.regions().most_legs() && flight.arc_length <= setup_->longest;
       ++legs) {
    const LoggedLeg logged(log, flight);
    end = leg(flight, neighbours, random);
    if (!end) {
      logged.drop();
      return;
    }
    logged.end();
    if (*end > at_boundary) {
      cross(flight, *end, neighbours, random);
      continue;
    }
    if (flight.arc_length > setup_->longest) return;
    flight.end = *end == at_collision ? Flight::End::collision : Flight::End::boundary;
    if (!flight.is_joinable) return;
    if (!neighbours.bent)
      flight.spreading = flight.arc_length * flight.arc_length;
    else if (neighbours.wanted)
      flight.spreading = std::abs(signed_spreading(neighbours.tangent, neighbours.n_start,
                                                   flight.start_direction, flight.direction));
    return;
  }
}

/// Nothing: lost.
std::optional<LegEnd> Space::leg(Flight& flight, Neighbours& neighbours,
                                 RandomStream& random) const {
  if (is_curved(flight.point.part)) return curved_leg(flight, neighbours, random);
  const double before = flight.arc_length, n = index(flight.point);
  const LegEnd end = setup_->stage.fly(flight, random);
  if (neighbours.bent)
    neighbours.tangent.dx += (flight.arc_length - before) / n * neighbours.tangent.dv;
  return end;
}

std::optional<LegEnd> Space::curved_leg(Flight& flight, Neighbours& neighbours,
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
  const LegEnd end = stop == LegStop::collision ? at_collision : end_on_surface(ray);
  end_leg(flight, ray, weight);
  return end;
}

LegEnd Space::end_on_surface(RayState& ray) const {
  const std::size_t nearest = room().nearest(ray.x);
  settle(room().surfaces[nearest], nearest == 0, 1e-9 * setup_->options.step, ray);
  return setup_->field_part + static_cast<LegEnd>(nearest);
}

void Space::end_leg(Flight& flight, const RayState& ray, double weight) const {
  if (!medium().scatters() && !medium().grid())
    weight *= transmittance(medium().mu_t(), ray.arc_length);
  attenuate(flight, weight);
  flight.point.x = ray.x;
  flight.direction = ray.v.normalized();
  flight.arc_length += ray.arc_length;
  flight.optical_path += ray.optical_path;
  flight.optical_depth += medium().reference() * ray.arc_length;
}

void Space::cross(Flight& flight, LegEnd surface, Neighbours& neighbours,
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

std::optional<Join> Space::join(const PathPoint& p, const PathPoint& q, RandomStream& random,
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
bool Space::stays_inside(RayState ray, double sigma, int steps) const {
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
bool Space::goes_outside(const Vec3& x, const Vec3& direction) const {
  const double on_surface = 1e-9 * setup_->options.step;
  return room().distance(x) >= -on_surface && direction.dot(room().normal(x)) > 0;
}

double Space::transmitted(const PathPoint& p, const Connection& curve, RandomStream& random) const {
  if (!medium().grid()) return transmittance(medium().mu_t(), curve.arc_length);
  return field_->ratio_tracked(leg_room(), start_ray(*field_, p.x, curve.start_direction),
                               curve.sigma, curve.steps, random);
}

std::unique_ptr<const Space> make_space(const AnyIndexField& field, const Stage& stage,
                                        const SpaceOptions& options) {
  check(stage);
  return std::make_unique<Space>(field, stage, options);
}

}  // namespace flatspeckle::grin
