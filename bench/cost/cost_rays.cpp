#include <algorithm>
#include <memory>
#include <numbers>

#include "bench/cost/cost_measure.h"
#include "grin/media/fields/luneburg.h"
#include "grin/rays/marching/ray_step.h"

namespace flatspeckle::bench {

using namespace grin;

namespace {

/// Returns the distance by which a ray that enters a Luneburg lens at height 0.6 misses the focus.
template <class Integrator>
double error_at_focus(int steps) {
  const Luneburg lens{LuneburgProfile{}};
  RayState ray = start_ray(lens, {-0.8, 0.6, 0}, Vec3::UnitX());
  for (int i = 0; i < steps; ++i) Integrator::step(lens, ray, std::numbers::pi / 2 / steps);
  return (ray.x - Vec3::UnitX()).norm();
}

using ErrorAtFocus = double (*)(int steps);

CostRun seconds_of_steps(const std::string& name, ErrorAtFocus trace) {
  const Scaling scaling{"ray, " + name, "steps", 32, 4096, 1, [trace](double steps) {
                          return [trace, steps, sum = std::make_shared<double>()] {
                            *sum += trace(static_cast<int>(steps));
                          };
                        }};
  return {scaling.what, [scaling](double cpu_seconds) {
            return measure_cost(scaling, std::min(cpu_seconds, 2.0));
          }};
}

/// Fits the order of an integrator where the power law holds: with coarser steps the error is not
/// yet asymptotic, with finer ones it is limited by rounding.
CostRun order(const std::string& name, int order, ErrorAtFocus trace) {
  const std::string what = "accuracy of a ray, " + name;
  return {what, [=](double) {
            CostCurve curve{what, "steps", {}, {}};
            for (int steps = 32; steps <= 256; steps *= 2) {
              curve.size.push_back(steps);
              curve.cpu_s.push_back(1 / trace(steps));
            }
            curve.expected = order;
            curve.cost_name = "1 / global error";
            fit_exponent(curve);
            return curve;
          }};
}

}  // namespace

std::vector<CostRun> ray_cost_runs() {
  return {seconds_of_steps("leapfrog", error_at_focus<Leapfrog>),
          seconds_of_steps("Yoshida", error_at_focus<Yoshida4>),
          seconds_of_steps("Sharma", error_at_focus<Sharma>),
          order("leapfrog", Leapfrog::order, error_at_focus<Leapfrog>),
          order("Yoshida", Yoshida4::order, error_at_focus<Yoshida4>),
          order("Sharma", Sharma::order, error_at_focus<Sharma>)};
}

}  // namespace flatspeckle::bench
