#pragma once

#include "core/error.h"
#include "grin/connections/connection_solver.h"
#include "grin/space/curved_leg.h"
#include "grin/space/curved_space.h"
#include "grin/space/straight_stage.h"

namespace flatspeckle::grin {

/// What is the same for every field, and shared by all frozen copies of a space.
struct CurvedSetup {
  StraightStage<RenderPlan{}> stage;
  double excess_around;
  Part field_part;
  CurvedSpaceOptions options;
  ConnectionOptions connection;

  CurvedSetup(const Stage& of, const CurvedSpaceOptions& with);
};

template <IndexField F>
class CurvedSpaceOf final : public CurvedSpace {
 public:
  CurvedSpaceOf(F field, std::shared_ptr<const CurvedSetup> setup)
      : field_(std::move(field)), setup_(std::move(setup)) {}

  double index(const PathPoint& p) const override {
    return 1 + (is_curved(p) ? field_.excess(p.x) : setup_->excess_around);
  }

  Flight fly(const PathPoint& from, const Vec3& direction, RandomStream& random) const override {
    Flight flight{.point = from, .start_direction = direction, .direction = direction};
    for (int leg = 0; leg < most_legs && flight.arc_length <= setup_->options.max_length; ++leg) {
      const bool curved = is_curved(flight.point);
      const auto end = curved ? curved_leg(flight, random)
                              : setup_->stage.fly(flight, 1 + setup_->excess_around, random);
      if (!end) return flight;
      if (end == LegEnd::body) {
        setup_->stage.cross(flight, field_.excess(flight.point.x), setup_->excess_around, random);
        continue;
      }
      if (flight.arc_length > setup_->options.max_length) return flight;
      flight.end = end == LegEnd::collision ? Flight::End::collision : Flight::End::boundary;
      if (!curved) flight.spreading = flight.arc_length * flight.arc_length;
      if (flight.crosses_body) flight.spreading = 0;
      return flight;
    }
    return flight;
  }

  std::optional<Join> join(const PathPoint& p, const PathPoint& q, RandomStream& random,
                           ConnectionStatistics& statistics) const override {
    if (p.part != q.part) return std::nullopt;
    if (!is_curved(p)) return setup_->stage.join(p, q, 1 + setup_->excess_around, random);
    const ConnectionTrial trial(field_, Within{&container()}, p.x, q.x, setup_->connection);
    const ConnectionEstimate estimate = connect_chord_first(trial, random, statistics);
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

  std::unique_ptr<const CurvedSpace> frozen(double phase) const override;

 private:
  struct Within {
    const Surface* surface;
    bool operator()(const Vec3& x) const { return distance(*surface, x) <= 0; }
  };

  bool is_curved(const PathPoint& p) const { return p.part == setup_->field_part; }
  const Surface& container() const { return setup_->stage.container(setup_->field_part); }
  const PartMedium& medium() const { return setup_->stage.medium(setup_->field_part); }

  /// From a point on the surface; the solver asks about the ends of its steps only.
  bool goes_outside(const Vec3& x, const Vec3& direction) const {
    const double on_surface = 1e-9 * setup_->options.step;
    return distance(container(), x) >= -on_surface && direction.dot(normal(container(), x)) > 0;
  }

  /// Nothing: lost.
  std::optional<LegEnd> curved_leg(Flight& flight, RandomStream& random) const {
    RayState ray = start_ray(field_, flight.point.x, flight.direction);
    const double n_start = ray.v.norm();
    const CurvedLeg<F> leg(field_, container(), medium(), setup_->options.step);
    const double longest = setup_->options.max_length - flight.arc_length;
    typename CurvedLeg<F>::Stop stop;
    if (setup_->options.spreading && !flight.crosses_body) {
      RayTangent tangent;
      stop = leg.go(longest, flight.weight, random, ray, tangent);
      flight.spreading = std::abs(signed_spreading(tangent, n_start, flight.direction, ray.v));
    } else {
      stop = leg.go(longest, flight.weight, random, ray);
    }
    if (stop == CurvedLeg<F>::Stop::lost) return std::nullopt;
    flight.point.x = ray.x;
    flight.direction = ray.v.normalized();
    flight.arc_length += ray.arc_length;
    flight.optical_path += ray.optical_path;
    flight.optical_depth += medium().reference() * ray.arc_length;
    if (!medium().scatters() && !medium().grid())
      flight.weight *= transmittance(medium().mu_t(), ray.arc_length);
    if (stop == CurvedLeg<F>::Stop::collision) return LegEnd::collision;
    return setup_->field_part == Part::body ? LegEnd::body : LegEnd::boundary;
  }

  double transmitted(const PathPoint& p, const Connection& curve, RandomStream& random) const {
    if (!medium().grid()) return transmittance(medium().mu_t(), curve.arc_length);
    const CurvedLeg<F> leg(field_, container(), medium(), setup_->options.step);
    return leg.ratio_tracked(start_ray(field_, p.x, curve.start_direction), curve.sigma,
                             curve.steps, random);
  }

  F field_;
  std::shared_ptr<const CurvedSetup> setup_;
};

/// The field of sound at a phase.
inline StandingWave at_phase(const StandingWave& field, double phase) {
  return field.frozen(std::cos(phase));
}
inline FocusedSound at_phase(const FocusedSound& field, double phase) {
  return field.frozen(phase);
}

template <IndexField F>
std::unique_ptr<const CurvedSpace> CurvedSpaceOf<F>::frozen(double phase) const {
  if constexpr (requires { at_phase(field_, phase); })
    return std::make_unique<CurvedSpaceOf<F>>(at_phase(field_, phase), setup_);
  else
    throw InputError("random_phase needs a single field of sound: ultrasound or focused_sound");
}

}  // namespace flatspeckle::grin
