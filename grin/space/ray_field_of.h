#pragma once

#include "core/error.h"
#include "grin/connections/connection_solver.h"
#include "grin/rays/trace.h"
#include "grin/space/curved_leg.h"
#include "grin/space/ray_field.h"

namespace flatspeckle::grin {

template <IndexField F>
class RayFieldOf final : public RayField {
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

  LegStop fly(const LegRoom& room, double longest, double& weight, RandomStream& random,
              RayState& ray, RayTangent* tangent) const override {
    const CurvedLeg<F> leg(field_, room);
    return tangent ? leg.go(longest, weight, random, ray, *tangent)
                   : leg.go(longest, weight, random, ray);
  }
  void advance(double sigma, int steps, RayState& ray, RayTangent* tangent) const override {
    for (int i = 0; i < steps; ++i) {
      if (tangent)
        Sharma::step(field_, ray, *tangent, sigma / steps);
      else
        Sharma::step(field_, ray, sigma / steps);
    }
  }
  double ratio_tracked(const LegRoom& room, const RayState& ray, double arc_length,
                       RandomStream& random) const override {
    return CurvedLeg<F>(field_, room).ratio_tracked(ray, arc_length, random);
  }
  double ratio_tracked(const LegRoom& room, const RayState& ray, double sigma, int steps,
                       RandomStream& random) const override {
    return CurvedLeg<F>(field_, room).ratio_tracked(ray, sigma, steps, random);
  }

  ConnectionEstimate connect(const CurveEnds& ends, const ConnectionOptions& options,
                             RandomStream& random,
                             ConnectionStatistics& statistics) const override {
    const ConnectionTrial trial(field_, ends.region, ends.from, ends.to, options);
    if constexpr (HomogeneousField<F>)
      return grin::connect(trial, random, statistics);
    else
      return connect_chord_first(trial, random, statistics);
  }
  std::vector<FoundConnection> connections(const CurveEnds& ends, const ConnectionOptions& options,
                                           std::uint64_t trials, RandomStream& random,
                                           ConnectionStatistics& statistics) const override {
    const ConnectionTrial trial(field_, ends.region, ends.from, ends.to, options);
    return all_connections(trial, trials, random, statistics);
  }

  std::unique_ptr<const RayField> frozen(double phase) const override {
    if constexpr (requires { at_phase(field_, phase); })
      return std::make_unique<RayFieldOf>(at_phase(field_, phase));
    else
      throw InputError("random_phase: needs the field ultrasound or focused_sound, and it alone");
  }

 private:
  F field_;
};

/// A field as it is for rays that end on this surface: steps that reach past it stay smooth.
template <IndexField F>
std::unique_ptr<const RayField> ray_field_within(const F& field, const Surface* end) {
  if constexpr (requires { smooth_within(field, Sphere()); })
    if (const Sphere* sphere = end ? std::get_if<Sphere>(end) : nullptr)
      return std::make_unique<RayFieldOf<F>>(smooth_within(field, *sphere));
  return std::make_unique<RayFieldOf<F>>(field);
}

template <std::size_t file, std::size_t number>
std::unique_ptr<const RayField> ray_field_from(const AnyIndexField& field, const Surface* end) {
  if constexpr (number < std::variant_size_v<AnyIndexField>) {
    if (const auto* of = std::get_if<number>(&field)) return ray_field_within(*of, end);
    return ray_field_from<file, number + ray_field_files>(field, end);
  }
  return nullptr;
}
template <std::size_t file>
std::unique_ptr<const RayField> ray_field_in(const AnyIndexField& field, const Surface* end) {
  return ray_field_from<file, file>(field, end);
}

}  // namespace flatspeckle::grin
