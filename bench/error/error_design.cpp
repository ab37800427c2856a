#include <cmath>

#include <omp.h>

#include "bench/baselines/gradient_searches.h"
#include "bench/error/error_modules.h"
#include "core/run/stopwatch.h"
#include "grin/design/objectives/even_points.h"
#include "grin/design/problem/designer.h"

namespace flatspeckle::bench {

namespace {

using namespace grin;
using namespace grin::design;

/// Returns the RMS error of the index over points distributed uniformly in the ball, divided by the
/// RMS of n.
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

double index_error(const FieldForm& form, const std::vector<double>& coefficients) {
  return std::visit([&](const auto& of) { return index_error(of, coefficients); }, form);
}

ErrorPoint sought(const DesignValues& values) {
  const double start = thread_cpu_seconds();
  const DesignScene scene = make_design_scene(values);
  Designer designer(scene);
  DesignState state = designer.begin();
  while (!state.ended) designer.advance(state);
  const double seconds = thread_cpu_seconds() - start;
  return {seconds, 0, index_error(designer.form(state), state.search.coefficients), 0};
}

/// Searches with the gradient alone, until the rays miss the focus by as little as in the
/// least-squares design.
template <class Search>
ErrorPoint by_gradient(const DesignValues& values, const Search& search) {
  constexpr double enough = 1e-8;  // square of an RMS miss distance of 1e-4
  constexpr long most_traces = 2000;
  const double start = thread_cpu_seconds();
  const DesignScene scene = make_design_scene(values);
  const DesignTask task = scene.design_target->task(scene.walk, false);
  FinerField field{scene.start.form, scene.start.coefficients};
  for (int level = 1; level < scene.start.levels; ++level)
    field = finer(field.form, field.coefficients);
  const SearchLimits limits{bounds_of(field.form, scene.start.least_index, scene.start.most_index),
                            enough, most_traces};
  const SearchResult found = search(GradientObjective(*task.rays, *task.objective, field.form),
                                    limits, field.coefficients);
  return {thread_cpu_seconds() - start, 0, index_error(field.form, found.coefficients), 0};
}

DesignValues profile(int coefficients) {
  DesignValues values;
  values.form.design = "radial";
  values.form.coefficients = coefficients;
  std::get<FocusValues>(values.design_target.kinds) = {.directions = 1, .rays_per_direction = 200};
  return values;
}
DesignValues ball(const std::vector<std::int64_t>& nodes) {
  DesignValues values;
  values.form.nodes = nodes;
  std::get<FocusValues>(values.design_target.kinds) = {
      .aperture = 0.995, .directions = 25, .rays_per_direction = 60};
  return values;
}

template <class Sought>
ErrorRun run_of(const char* method, const std::vector<DesignValues>& scenes, const Sought& point_of,
                bool slow = false) {
  const char* const lens = "lens from n = 1";
  return {lens, method,
          [=](double) {
            omp_set_num_threads(1);
            ErrorCurve curve{lens, method, "Luneburg's closed form", 0, {}};
            curve.is_monte_carlo = false;
            for (const DesignValues& values : scenes) curve.points.push_back(point_of(values));
            return curve;
          },
          slow};
}

}  // namespace

std::vector<ErrorRun> design_error_runs() {
  constexpr bool slow = true;
  const std::vector<DesignValues> profiles{profile(4), profile(6), profile(8)};
  const auto adam = [](const DesignValues& values) {
    return by_gradient(values, [](const auto&... of) { return by_adam(of..., 0.03); });
  };
  const auto lbfgs = [](const DesignValues& values) { return by_gradient(values, by_lbfgs); };
  return {run_of("radial profile", profiles, sought),
          run_of("L-BFGS, radial profile", profiles, lbfgs, slow),
          run_of("Adam, radial profile", profiles, adam, slow),
          run_of("spline in space", {ball({3}), ball({5}), ball({5, 9})}, sought, slow)};
}

}  // namespace flatspeckle::bench
