// Comparisons for the design module: derivatives of rays with respect to the field.

#include <memory>

#include "bench/plan/plan_timing.h"
#include "grin/design/problem/designer.h"

namespace flatspeckle::bench {

namespace {

using namespace grin::design;

/// A lens under design: the loss of rays that should meet in a focus, and its derivatives.
class LensUnderDesign {
 public:
  explicit LensUnderDesign(int coefficients)
      : scene_(scene(coefficients)), task_(scene_.design_target->task(scene_.walk, false)) {}

  std::vector<Complex> by_reversed_rays() {
    objective().loss(start_);  // replaces the cached trace
    const auto gradient = objective().gradient(*objective().residuals(at_));
    return {gradient.begin(), gradient.end()};
  }
  /// Returns the gradient by central differences in each coefficient.
  std::vector<Complex> by_differences() {
    constexpr double step = 1e-5;
    std::vector<Complex> all;
    for (std::size_t i = 0; i < at_.size(); ++i) {
      const auto loss = [&](double by) {
        auto moved = at_;
        moved[i] += by;
        return objective().loss(moved);
      };
      all.emplace_back((loss(step) - loss(-step)) / (2 * step));
    }
    return all;
  }

 private:
  static DesignScene scene(int coefficients) {
    DesignValues values;
    values.form.design = "radial";
    values.form.coefficients = coefficients;
    auto& light = std::get<FocusValues>(values.design_target.kinds);
    light.directions = 1;
    light.rays_per_direction = 30;
    return make_design_scene(values);
  }
  Objective objective() { return {*task_.rays, *task_.objective, form_}; }

  DesignScene scene_;
  DesignTask task_;
  FieldForm form_ = finer(scene_.start.form, scene_.start.coefficients).form;
  std::vector<double> start_ = std::vector<double>(shape_of(form_).size(), 0.0);
  std::vector<double> at_ = std::vector<double>(shape_of(form_).size(), 0.3);
};

}  // namespace

std::vector<PlanCase> design_plan_cases() {
  return {case_of_values(
      {"design", "a trace for each coefficient", "lens of 40 coefficients", "gradient"}, 1e-6,
      [](bool) -> TwoAlternatives {
        const auto lens = std::make_shared<LensUnderDesign>(40);
        return {[=] { return lens->by_differences(); }, [=] { return lens->by_reversed_rays(); }};
      })};
}

}  // namespace flatspeckle::bench
