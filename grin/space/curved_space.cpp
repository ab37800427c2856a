#include "grin/space/curved_space.h"

#include <cmath>

#include "grin/connections/geometric_spreading.h"

namespace flatspeckle::grin {

std::unique_ptr<const RayField> make_ray_field(const AnyIndexField& field, const Surface* end) {
  constexpr decltype(&make_ray_field) in_file[ray_field_files] = {ray_field_in<0>, ray_field_in<1>,
                                                                  ray_field_in<2>};
  return in_file[field.index() % ray_field_files](field, end);
}

namespace {

bool refracts_nowhere(const AnyIndexField& field, const Stage& stage) {
  const auto* homogeneous = std::get_if<Homogeneous>(&field);
  return homogeneous && stage.body && homogeneous->n_excess == stage.excess_around;
}

}  // namespace

CurvedSpace::CurvedSpace(const AnyIndexField& field, const Stage& stage,
                         const CurvedSpaceOptions& options)
    : setup_(std::make_shared<const Setup>(
          Setup{.stage = StraightStage<RenderPlan{}>(stage),
                .excess_around = stage.excess_around,
                .field_part = stage.body ? Part::body : Part::stage,
                .is_straight = std::holds_alternative<Homogeneous>(field),
                .is_clear = refracts_nowhere(field, stage),
                .options = options,
                .connection = {.step = options.step,
                               .max_length = options.max_length,
                               .start = {.chord_share = 0.2},
                               .tolerance = 1e-8,
                               .count_caustics = false}})),
      field_(make_ray_field(field, &container())) {}

std::unique_ptr<const CurvedSpace> CurvedSpace::frozen(double phase) const {
  return std::unique_ptr<const CurvedSpace>(new CurvedSpace(setup_, field_->frozen(phase)));
}

Flight CurvedSpace::fly(const PathPoint& from, const Vec3& direction, RandomStream& random) const {
  Flight flight{.point = from, .start_direction = direction, .direction = direction};
  const double longest =
      setup_->is_straight ? std::numeric_limits<double>::infinity() : setup_->options.max_length;
  for (int leg = 0; leg < most_legs && flight.arc_length <= longest; ++leg) {
    const bool curved = is_curved(flight.point);
    const auto end = curved ? curved_leg(flight, random)
                            : setup_->stage.fly(flight, index(flight.point), random);
    if (!end) return flight;
    if (end == LegEnd::body) {
      flight.is_joinable &= is_clear();
      setup_->stage.cross(flight, field_->excess(flight.point.x), setup_->excess_around, random);
      continue;
    }
    if (flight.arc_length > longest) return flight;
    flight.end = end == LegEnd::collision ? Flight::End::collision : Flight::End::boundary;
    if (!curved) flight.spreading = flight.arc_length * flight.arc_length;
    if (!flight.is_joinable) flight.spreading = 0;
    return flight;
  }
  return flight;
}

/// Nothing: lost.
std::optional<LegEnd> CurvedSpace::curved_leg(Flight& flight, RandomStream& random) const {
  RayState ray = start_ray(*field_, flight.point.x, flight.direction);
  const double n_start = ray.v.norm();
  const double longest = setup_->options.max_length - flight.arc_length;
  const bool spreads = setup_->options.spreading && flight.is_joinable;
  RayTangent tangent;
  const LegStop stop =
      field_->fly(room(), longest, flight.weight, random, ray, spreads ? &tangent : nullptr);
  if (spreads)
    flight.spreading = std::abs(signed_spreading(tangent, n_start, flight.direction, ray.v));
  if (stop == LegStop::lost) return std::nullopt;
  flight.point.x = ray.x;
  flight.direction = ray.v.normalized();
  flight.arc_length += ray.arc_length;
  flight.optical_path += ray.optical_path;
  flight.optical_depth += medium().reference() * ray.arc_length;
  if (!medium().scatters() && !medium().grid())
    flight.weight *= transmittance(medium().mu_t(), ray.arc_length);
  if (stop == LegStop::collision) return LegEnd::collision;
  return setup_->field_part == Part::body ? LegEnd::body : LegEnd::boundary;
}

std::optional<Join> CurvedSpace::join(const PathPoint& p, const PathPoint& q, RandomStream& random,
                                      ConnectionStatistics& statistics) const {
  if (is_clear()) return setup_->stage.join_through(p, q, index(p), random);
  if (p.part != q.part) return std::nullopt;
  if (!is_curved(p)) return setup_->stage.join(p, q, index(p), random);
  static constexpr double inside = 1;
  const CurveEnds ends{p.x, q.x, {{&container(), 1}, {&inside, 1}}};
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

/// From a point on the surface; the solver asks about the ends of its steps only.
bool CurvedSpace::goes_outside(const Vec3& x, const Vec3& direction) const {
  const double on_surface = 1e-9 * setup_->options.step;
  return distance(container(), x) >= -on_surface && direction.dot(normal(container(), x)) > 0;
}

double CurvedSpace::transmitted(const PathPoint& p, const Connection& curve,
                                RandomStream& random) const {
  if (!medium().grid()) return transmittance(medium().mu_t(), curve.arc_length);
  return field_->ratio_tracked(room(), start_ray(*field_, p.x, curve.start_direction), curve.sigma,
                               curve.steps, random);
}

std::unique_ptr<const CurvedSpace> make_curved_space(const AnyIndexField& field, const Stage& stage,
                                                     const CurvedSpaceOptions& options) {
  check(stage);
  return std::make_unique<CurvedSpace>(field, stage, options);
}

}  // namespace flatspeckle::grin
