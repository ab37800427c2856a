#include "bench/error/error_design.h"

#include <cmath>

#include <omp.h>

#include "core/run/stopwatch.h"
#include "grin/design/goals/even_points.h"
#include "grin/design/problem/designer.h"

namespace flatspeckle::bench {

namespace {

using namespace grin;
using namespace grin::design;

/// Over places that fill the ball evenly, relative to the root mean square of n.
template <class Form>
double index_error(const Form& form, const std::vector<double>& coefficients) {
  constexpr int places = 500;
  const auto field = form.field(coefficients);
  double off = 0, all = 0;
  for (int i = 0; i < places; ++i) {
    const double r = 0.9 * std::cbrt((i + 0.5) / places);
    const Vec3 x = r * even_direction(i, places, 0);
    const double exact = std::sqrt(2 - r * r);
    off += std::pow(index(field, x) - exact, 2);
    all += exact * exact;
  }
  return std::sqrt(off / all);
}

ErrorPoint sought(const DesignValues& values) {
  const double start = thread_cpu_seconds();
  const DesignScene scene = make_design_scene(values);
  Designer designer(scene);
  DesignState state = designer.begin();
  while (!state.ended) designer.advance(state);
  const double seconds = thread_cpu_seconds() - start;
  const double error =
      std::visit([&](const auto& form) { return index_error(form, state.search.coefficients); },
                 designer.form(state));
  return {seconds, 0, error, 0};
}

DesignValues profile(int coefficients) {
  DesignValues values;
  values.form.design = "radial";
  values.form.coefficients = coefficients;
  std::get<FocusValues>(values.aim.kinds) = {.directions = 1, .rays_per_direction = 200};
  return values;
}
DesignValues ball(const std::vector<std::int64_t>& nodes) {
  DesignValues values;
  values.form.nodes = nodes;
  std::get<FocusValues>(values.aim.kinds) = {
      .aperture = 0.995, .directions = 25, .rays_per_direction = 60};
  return values;
}

ErrorCurve curve_of(const char* method, const std::vector<DesignValues>& scenes) {
  omp_set_num_threads(1);
  ErrorCurve curve{"lens from n = 1", method, "Luneburg's closed form", 0, {}};
  curve.is_monte_carlo = false;
  for (const DesignValues& values : scenes) curve.points.push_back(sought(values));
  return curve;
}

}  // namespace

std::vector<ErrorRun> design_error_runs() {
  constexpr bool slow = true;
  return {{"lens from n = 1", "radial profile",
           [](double) {
             return curve_of("radial profile", {profile(4), profile(6), profile(8)});
           }},
          {"lens from n = 1", "spline in space",
           [](double) {
             return curve_of("spline in space", {ball({3}), ball({5}), ball({5, 9})});
           },
           slow}};
}

}  // namespace flatspeckle::bench
