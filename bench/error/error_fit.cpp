#include "bench/error/error_fit.h"

#include <cmath>
#include <numbers>
#include <utility>

#include <omp.h>

#include "bench/error/error_measure.h"
#include "bench/scenes/synthetic_slab.h"
#include "core/run/stopwatch.h"

namespace flatspeckle::bench {

namespace {

constexpr double g = 0.8, albedo = 0.98, optical_depth = 4;

/// A view in transmission, one in reflection, and the transmittance, with errors of this share.
mc::FitTask task(double share) {
  SyntheticSlab slab(2000, g, albedo, optical_depth);
  for (const double view : {0.3, std::numbers::pi - 0.44}) slab.add_curve(view, {1.25, 2.5, 5, 10});
  slab.add_transmittance();
  mc::MovingSpec none;
  none.scatterer = "hg";
  mc::FitTask task;
  task.free = mc::read_free_parameters({"g=0.5:0.95"}, none);
  task.measurements = slab.exact(share);
  for (mc::Measurement& one : task.measurements)
    for (mc::Curve& curve : one.curves) {
      curve.scene.albedo = albedo;
      curve.scene.optical_depth = optical_depth;
    }
  return task;
}

double relative_square(const mc::MediumFit& fit) {
  return std::pow(fit.estimates[0] / g - 1, 2);
}

ErrorCurve empty_curve(const std::string& method) {
  return {"fit of a slab", method, "the slab that curves are made of", 1e-6, {}};
}

ErrorCurve by_transport() {
  omp_set_num_threads(1);
  ErrorCurve curve = empty_curve("transport");
  curve.is_monte_carlo = false;
  for (const double share : {0.03, 0.003, 0.0003}) {
    const auto wanted = task(share);
    const double start = thread_cpu_seconds();
    const double off = std::sqrt(relative_square(mc::fit_medium(wanted)));
    curve.points.push_back({thread_cpu_seconds() - start, 0, off, 0});
  }
  return curve;
}

/// Some fits by other random numbers each.
ErrorPoint by_paths(double share) {
  constexpr unsigned fits = 12;
  auto wanted = task(share);
  double squares = 0, paths = 0;
  const double start = thread_cpu_seconds();
  for (unsigned seed = 1; seed <= fits; ++seed) {
    wanted.paths.emplace().seed = seed;
    const mc::MediumFit fit = mc::fit_medium(wanted);
    squares += relative_square(fit) / fits;
    paths += fit.paths / fits;
  }
  const double error = std::sqrt(squares);
  return {(thread_cpu_seconds() - start) / fits, paths, error, error / std::sqrt(2.0 * fits)};
}

/// Errors of half the share each, as long as there is time. The search costs paths too, and takes
/// other steps by chance: the slope is not that of one sum.
ErrorCurve by_paths_against_time(double cpu_seconds) {
  constexpr std::size_t fewest = 3;
  omp_set_num_threads(1);
  ErrorCurve curve = empty_curve("paths");
  curve.is_monte_carlo = false;
  const double start = thread_cpu_seconds();
  double spent = 0, last = 0;
  for (double share = 0.04; curve.points.size() < fewest || spent + 4 * last < cpu_seconds;
       share /= 2) {
    curve.points.push_back(by_paths(share));
    last = thread_cpu_seconds() - start - spent;
    spent += last;
  }
  set_plain_slope(curve);
  return curve;
}

}  // namespace

std::vector<ErrorRun> fit_error_runs() {
  constexpr bool slow = true;
  return {{"fit of a slab", "transport", [](double) { return by_transport(); }, slow},
          {"fit of a slab", "paths", by_paths_against_time, slow}};
}

}  // namespace flatspeckle::bench
