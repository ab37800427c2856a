#include "grin/render/flights/space.h"

#include <algorithm>
#include <cmath>

#include "grin/rays/connections/geometric_spreading.h"
#include "grin/rays/marching/watch.h"
#include "grin/rays/surfaces/first_crossing.h"

namespace flatspeckle::grin {

namespace {

/// Returns index - 1 of a homogeneous field, nullopt for other fields.
std::optional<double> excess_of(const AnyIndexField& field) {
  const auto* homogeneous = std::get_if<Homogeneous>(&field);
  return homogeneous ? std::optional(homogeneous->n_excess) : std::nullopt;
}

/// Returns Setup::sides: the field's region is inside the first of its surfaces and outside the
/// others.
std::vector<double> sides_of_box(const Stage& stage) {
  std::vector<double> sides(stage.parts() - stage.field_part(), -1);
  sides.front() = 1;
  return sides;
}

/// Options for connections along curved rays of the field.
ConnectionOptions curve_options(const SpaceOptions& options) {
  return {.step = options.step,
          .max_length = options.max_length,
          .start = {.chord_share = 0.2},
          .tolerance = 1e-8,
          .carry = 3e-7,
          .count_caustics = false};
}
/// Options for specular connections and connections to beams.
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
                .sides = sides_of_box(stage),
                .options = options,
                .longest =
                    excess_of(field) ? std::numeric_limits<double>::infinity() : options.max_length,
                .connection = curve_options(options),
                .search = search_options(options, excess_of(field).has_value())})),
      field_(make_ray_field(field, region().surfaces, options.leapfrogs)) {}

std::unique_ptr<const Space> Space::frozen(double phase) const {
  return std::unique_ptr<const Space>(new Space(setup_, field_->frozen(phase)));
}

/// Derivatives of the rays next to a flight, from which its spreading |J| follows.
struct Space::Neighbours {
  bool wanted;
  bool bent = false;  ///< whether the ray has been bent, by the field or at the surface of a body
  double n_start = 0;
  RayTangent tangent = {};
};

namespace {

/// Logs the next segment of a flight.
class LoggedSegment {
 public:
  LoggedSegment(FlightLog* log, const Flight& flight) : log_(log), flight_(flight) {
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

/// Traces a flight, and traces it a second time with |J| if it has reached the boundary; this is
/// cheaper than computing |J| for all flights of a long path.
Flight Space::fly_again_to_boundary(const PathPoint& from, const Vec3& direction,
                                    RandomStream& random, const Vec3* log_gradient) const {
  RandomStream again = random;
  const Flight flight = fly_once(from, direction, false, random, nullptr, log_gradient);
  if (flight.end != Flight::End::boundary) return flight;
  return fly_once(from, direction, true, again, nullptr, log_gradient);
}

Flight Space::fly_once(const PathPoint& from, const Vec3& direction, bool spreads,
                       RandomStream& random, FlightLog* log, const Vec3* log_gradient) const {
  Flight flight{.point = from, .start_direction = direction, .direction = direction};
  if (is_curved(from.part)) {
    go_on(flight, std::nullopt, spreads, random, log);
    return flight;
  }
  const LoggedSegment logged(log, flight);
  const SegmentEnd end = setup_->stage.fly(flight, random, log_gradient);
  logged.end();
  if (end > at_boundary) {
    go_on(flight, end, spreads, random, log);
  } else if (flight.arc_length <= setup_->longest) {
    flight.end = end == at_collision ? Flight::End::collision : Flight::End::boundary;
    flight.spreading = flight.arc_length * flight.arc_length;
  }
  return flight;
}

/// Traces a flight to its end. end: surface of the body on which an already traced first segment
/// has ended; nullopt if no segment has been traced.
void Space::go_on(Flight& flight, std::optional<SegmentEnd> end, bool spreads, RandomStream& random,
                  FlightLog* log) const {
  Neighbours neighbours{spreads};
  int segments = 0;
  if (end) {
    neighbours.n_start = index(flight.point);
    cross(flight, *end, neighbours, random);
    ++segments;
  }
  for (; segments < setup_->stage.regions().most_segments() && flight.arc_length <= setup_->longest;
       ++segments) {
    const LoggedSegment logged(log, flight);
    end = next_segment(flight, neighbours, random);
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
    if (!flight.is_connectable) return;
    if (!neighbours.bent)
      flight.spreading = flight.arc_length * flight.arc_length;
    else if (neighbours.wanted)
      flight.spreading = std::abs(signed_spreading(neighbours.tangent, neighbours.n_start,
                                                   flight.start_direction, flight.direction));
    return;
  }
}

/// Traces the next segment; returns nullopt if the ray is lost.
std::optional<SegmentEnd> Space::next_segment(Flight& flight, Neighbours& neighbours,
                                              RandomStream& random) const {
  if (is_curved(flight.point.part)) return curved_segment(flight, neighbours, random);
  const double before = flight.arc_length, n = index(flight.point);
  const SegmentEnd end = setup_->stage.fly(flight, random);
  if (neighbours.bent)
    neighbours.tangent.dx += (flight.arc_length - before) / n * neighbours.tangent.dv;
  return end;
}

std::optional<SegmentEnd> Space::curved_segment(Flight& flight, Neighbours& neighbours,
                                                RandomStream& random) const {
  RayState ray = start_ray(*field_, flight.point.x, flight.direction);
  if (flight.arc_length == 0) neighbours.n_start = ray.v.norm();
  neighbours.bent = true;
  const double longest = setup_->options.max_length - flight.arc_length;
  const bool follows = neighbours.wanted && flight.is_connectable;
  double weight = flight.weight;
  const SegmentStop stop = field_->fly(segment_domain(), longest, weight, random, ray,
                                       follows ? &neighbours.tangent : nullptr);
  if (stop == SegmentStop::lost) return std::nullopt;
  const SegmentEnd end = stop == SegmentStop::collision ? at_collision : end_on_surface(ray);
  end_segment(flight, ray, weight);
  return end;
}

SegmentEnd Space::end_on_surface(RayState& ray) const {
  const std::size_t nearest = region().nearest(ray.x);
  settle(region().surfaces[nearest], nearest == 0, 1e-9 * setup_->options.step, ray);
  return setup_->field_part + static_cast<SegmentEnd>(nearest);
}

void Space::end_segment(Flight& flight, const RayState& ray, double weight) const {
  if (!medium().scatters() && !medium().varies())
    weight *= transmittance(medium().mu_t(), ray.arc_length);
  attenuate(flight, weight);
  flight.point.x = ray.x;
  flight.direction = ray.v.normalized();
  flight.arc_length += ray.arc_length;
  flight.optical_path += ray.optical_path;
  flight.optical_depth += medium().reference() * ray.arc_length;
}

void Space::cross(Flight& flight, SegmentEnd surface, Neighbours& neighbours,
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

std::optional<TestConnection> Space::connect(const PathPoint& p, const PathPoint& q,
                                             RandomStream& random,
                                             ConnectionStatistics& statistics) const {
  if (!is_curved(p.part)) return setup_->stage.connect(p, q, random);
  if (p.part != q.part) return std::nullopt;
  const double slack =
      1e-7 * ((q.x - p.x).norm() + setup_->options.step);  // the end points may be on the surface
  const CurveEndpoints ends{p.x, q.x, {region().surfaces, setup_->sides, slack}};
  const ConnectionEstimate estimate = field_->connect(ends, setup_->connection, random, statistics);
  if (!estimate.curve) return std::nullopt;
  const Connection& curve = *estimate.curve;
  if (goes_outside(p.x, curve.start_direction) || goes_outside(q.x, -curve.end_direction))
    return std::nullopt;
  return TestConnection{.start_direction = curve.start_direction,
                        .end_direction = curve.end_direction,
                        .spreading = curve.spreading,
                        .optical_path = curve.optical_path,
                        .optical_depth = medium().reference() * curve.arc_length,
                        .transmittance = transmitted(p, curve, random),
                        .multiplicity = estimate.multiplicity};
}

/// Whether a ray stays inside the region for this number of steps, also between the end points of
/// the steps.
bool Space::stays_inside(RayState ray, double sigma, int steps) const {
  const double h = sigma / steps, slack = 1e-7 * (sigma + h);  // endpoints may be on the surface
  for (int i = 0; i < steps; ++i) {
    const RayState before = ray;
    field_->advance(h, 1, ray, nullptr);
    const StepCurve curve(before, ray, h);
    const auto depth = [&](double theta) { return slack - region().distance(curve.x(theta)); };
    const double arc = 1.1 * (ray.arc_length - before.arc_length);
    if (first_change(depth, {0, 1, depth(0), depth(1)}, arc)) return false;
  }
  return true;
}

/// Whether x is on the surface of the region and the direction leads out of the region.
bool Space::goes_outside(const Vec3& x, const Vec3& direction) const {
  const double on_surface = 1e-9 * setup_->options.step;
  return region().distance(x) >= -on_surface && direction.dot(region().normal(x)) > 0;
}

double Space::transmitted(const PathPoint& p, const Connection& curve, RandomStream& random) const {
  if (!medium().varies()) return transmittance(medium().mu_t(), curve.arc_length);
  return field_->ratio_tracked(segment_domain(), start_ray(*field_, p.x, curve.start_direction),
                               curve.sigma, curve.steps, random);
}

std::unique_ptr<const Space> make_space(const AnyIndexField& field, const Stage& stage,
                                        const SpaceOptions& options) {
  check(stage);
  return std::make_unique<Space>(field, stage, options);
}

}  // namespace flatspeckle::grin
