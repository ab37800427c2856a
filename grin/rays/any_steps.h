#pragma once

#include <cmath>
#include <optional>
#include <string>
#include <variant>

#include "grin/rays/ray_path.h"
#include "grin/rays/stepper.h"

namespace flatspeckle::grin {

/// All integrators; the one list of them.
using Integrators = std::variant<Sharma, Yoshida4, Leapfrog>;

/// One of them, chosen at run time: a call for each step.
struct AnyIntegrator {
  Integrators which;
  int order = std::visit([](const auto& integrator) { return integrator.order; }, which);

  template <IndexField F>
  void step(const F& field, RayState& ray, double h) const {
    std::visit([&](const auto& integrator) { integrator.step(field, ray, h); }, which);
  }
};

/// Steps of equal length, or controlled by a tolerance.
struct RaySteps {
  Integrators integrator;
  double longest;
  std::optional<double> tolerance = {};
};

/// Steps as trace() takes them, and what is to be known of a ray on its way.
class LoggedSteps {
 public:
  LoggedSteps(const RaySteps& steps, bool keeps_path)
      : is_controlled_(steps.tolerance),
        controlled_{steps.tolerance.value_or(0), steps.longest / 16, steps.longest,
                    AnyIntegrator{steps.integrator}},
        fixed_{steps.longest, controlled_.integrator},
        keeps_path_(keeps_path) {}

  template <IndexField F>
  void step(const F& field, double h, RayState& ray) const {
    is_controlled_ ? controlled_.step(field, h, ray) : fixed_.step(field, h, ray);
  }
  template <IndexField F>
  double advance(const F& field, RayState& ray) {
    const double h = is_controlled_ ? controlled_.advance(field, ray) : fixed_.advance(field, ray);
    look(field, ray);
    if (keeps_path_) path_.add(ray);
    return h;
  }

  void start(const RayState& ray) {
    if (keeps_path_) path_.add(ray);
  }
  /// Here, whatever the steps went beyond.
  template <IndexField F>
  void end(const F& field, const RayState& ray) {
    if (keeps_path_) path_.end_with(ray);
    look(field, ray);
  }

  /// Largest ||v| - n| on the way.
  double index_mismatch() const { return index_mismatch_; }
  const RayPath& path() const { return path_; }

 private:
  template <IndexField F>
  void look(const F& field, const RayState& ray) {
    // NaN, beyond the last index, is not kept
    index_mismatch_ = std::max(index_mismatch_, std::abs(ray.v.norm() - index(field, ray.x)));
  }

  bool is_controlled_;
  ControlledSteps<AnyIntegrator> controlled_;
  FixedSteps<AnyIntegrator> fixed_;
  bool keeps_path_;
  double index_mismatch_ = 0;
  RayPath path_;
};

}  // namespace flatspeckle::grin
