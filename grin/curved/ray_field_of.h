#pragma once

#include "core/error.h"
#include "grin/connections/connection_solver.h"
#include "grin/curved/curved_leg.h"
#include "grin/curved/ray_field.h"
#include "grin/rays/trace.h"

namespace flatspeckle::grin {

template <IndexField F, class Step = Sharma>
class RayFieldOf : public RayField {
 public:
  explicit RayFieldOf(F field) : field_(std::move(field)) {}

  double excess(const Vec3& x) const override { return field_.excess(x); }
  IndexGradient gradient(const Vec3& x) const override { return field_.gradient(x); }
  IndexHessian hessian(const Vec3& x) const override { return field_.hessian(x); }

  TraceEnd follow(std::span<const Surface> surfaces, const TraceLimits& limits, RayLog& log,
                  RayState& ray) const override {
    const auto by = [&]<class Integrator>(const Integrator&) {
      LoggedSteps<Integrator> steps(log);
      return trace(field_, surfaces, limits, steps, ray);
    };
    const TraceEnd end = std::visit(by, log.steps().integrator);
    log.end(field_, ray);
    return end;
  }

  bool has_lanes() const override { return LaneField<F>; }
  void follow_lanes([[maybe_unused]] const Integrators& integrator, [[maybe_unused]] int steps,
                    [[maybe_unused]] RayLanes& rays) const override {
    if constexpr (LaneField<F>)
      std::visit([&](const auto& by) { make_steps<true>(by, field_, rays, steps); }, integrator);
  }
  void advance_lanes([[maybe_unused]] int steps, [[maybe_unused]] RayLanes& rays) const override {
    if constexpr (LaneField<F>) make_steps<false>(Step(), field_, rays, steps);
  }

  LegStop fly(const LegRoom& room, double longest, double& weight, RandomStream& random,
              RayState& ray, RayTangent* tangent) const override {
    const CurvedLeg<F, Step> leg(field_, room);
    return tangent ? leg.go(longest, weight, random, ray, *tangent)
                   : leg.go(longest, weight, random, ray);
  }
  LegStop go_on(const LegRoom& room, double longest, int most_steps, LegProgress& progress,
                RandomStream& random, RayState& ray) const override {
    return CurvedLeg<F, Step>(field_, room).go_on(longest, most_steps, progress, random, ray);
  }
  void advance(double sigma, int steps, RayState& ray, RayTangent* tangent) const override {
    for (int i = 0; i < steps; ++i) {
      if (tangent)
        Step::step(field_, ray, *tangent, sigma / steps);
      else
        Step::step(field_, ray, sigma / steps);
    }
  }
  double ratio_tracked(const LegRoom& room, const RayState& ray, double arc_length,
                       RandomStream& random) const override {
    return CurvedLeg<F, Step>(field_, room).ratio_tracked(ray, arc_length, random);
  }
  double ratio_tracked(const LegRoom& room, const RayState& ray, double sigma, int steps,
                       RandomStream& random) const override {
    return CurvedLeg<F, Step>(field_, room).ratio_tracked(ray, sigma, steps, random);
  }

  double cost_of_curve() const override { return std::same_as<Step, Leapfrog> ? 2 : 4; }
  ConnectionEstimate connect(const CurveEnds& ends, const ConnectionOptions& options,
                             RandomStream& random,
                             ConnectionStatistics& statistics) const override {
    const Trial trial(field_, ends.region, ends.from, ends.to, options);
    if constexpr (HomogeneousField<F>)
      return grin::connect(trial, random, statistics);
    else
      return connect_chord_first(trial, random, statistics);
  }
  std::vector<FoundConnection> connections(const CurveEnds& ends, const ConnectionOptions& options,
                                           std::uint64_t trials, RandomStream& random,
                                           ConnectionStatistics& statistics) const override {
    const Trial trial(field_, ends.region, ends.from, ends.to, options);
    return all_connections(trial, trials, random, statistics);
  }

  std::unique_ptr<const RayField> frozen(double phase) const override {
    if constexpr (requires { at_phase(field_, phase); })
      return std::make_unique<RayFieldOf>(at_phase(field_, phase));
    else
      throw InputError(
          "random_phase: needs the field ultrasound, focused_sound or transducers, and it alone");
  }

 private:
  using Trial = ConnectionTrial<F, Sides, Step>;

  F field_;
};

}  // namespace flatspeckle::grin
