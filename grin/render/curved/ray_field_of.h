#pragma once

#include "core/error.h"
#include "grin/rays/marching/trace.h"
#include "grin/render/curved/ray_field.h"

namespace flatspeckle::grin {

/// RayField of a given type of field. Step: the integrator that suits the field.
template <IndexField F, class Step = Sharma>
class RayFieldOf : public RayField {
 public:
  explicit RayFieldOf(F field) : field_(std::move(field)) {}

  double excess(const Vec3& x) const override { return field_.excess(x); }
  IndexGradient gradient(const Vec3& x) const override { return field_.gradient(x); }
  IndexHessian hessian(const Vec3& x) const override { return field_.hessian(x); }

  void step(RayState& ray, double h) const override { Step::step(field_, ray, h); }
  void step(RayState& ray, RayTangent& tangent, double h) const override {
    Step::step(field_, ray, tangent, h);
  }
  void leap(RayState& ray, double h) const override { Leapfrog::step(field_, ray, h); }
  void leap(RayState& ray, RayTangent& tangent, double h) const override {
    Leapfrog::step(field_, ray, tangent, h);
  }
  bool leapfrogs() const override { return std::same_as<Step, Leapfrog>; }
  void advance(double sigma, int steps, RayState& ray, RayTangent* tangent) const override {
    for (int i = 0; i < steps; ++i) {
      if (tangent)
        Step::step(field_, ray, *tangent, sigma / steps);
      else
        Step::step(field_, ray, sigma / steps);
    }
  }

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
    if constexpr (LaneField<F>) {
      std::visit([&](const auto& by) { make_steps(by, field_, rays, steps); }, integrator);
      check_for_mismatch(field_, rays);
    }
  }
  void advance_lanes([[maybe_unused]] int steps, [[maybe_unused]] RayLanes& rays) const override {
    if constexpr (LaneField<F>) make_steps(Step(), field_, rays, steps);
  }

  std::unique_ptr<const RayField> frozen(double phase) const override {
    if constexpr (requires { at_phase(field_, phase); })
      return std::make_unique<RayFieldOf>(at_phase(field_, phase));
    else
      throw InputError(
          "random_phase: requires field = ultrasound, focused_sound or transducers alone");
  }

 private:
  F field_;
};

}  // namespace flatspeckle::grin
