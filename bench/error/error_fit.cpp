#include <cmath>
#include <numbers>

#include <omp.h>

#include "bench/error/error_modules.h"
#include "bench/scenes/synthetic_slab.h"

namespace flatspeckle::bench {

namespace {

constexpr double g = 0.8, albedo = 0.98, optical_depth = 4;

/// Returns the task of fitting g to curves for one detection direction in transmission and one in
/// reflection and to the transmittance, all with relative errors `share`.
mc::FitTask task(double share) {
  SyntheticSlab slab(2000, g, albedo, optical_depth);
  for (const double view : {0.3, std::numbers::pi - 0.44}) slab.add_curve(view, {1.25, 2.5, 5, 10});
  slab.add_transmittance();
  return slab_task(slab.exact(share), {"g=0.5:0.95"}, [](mc::MovingSpec& scene) {
    scene.albedo = albedo;
    scene.optical_depth = optical_depth;
  });
}

double relative_square(const mc::MediumFit& fit) {
  return std::pow(fit.estimates[0] / g - 1, 2);
}

ErrorCurve empty_curve(const std::string& method) {
  return {"fit of a slab", method, "the slab from which the curves are computed", 1e-6, {}};
}

ErrorCurve by_transport(double) {
  omp_set_num_threads(1);
  ErrorCurve curve = empty_curve("transport");
  curve.is_monte_carlo = false;
  for (const double share : {0.03, 0.003, 0.0003}) {
    const auto wanted = task(share);
    const OneRun run = timed_run(0, [&] { return relative_square(mc::fit_medium(wanted)); });
    curve.points.push_back({run.cpu_s, 0, std::sqrt(run.square), 0});
  }
  return curve;
}

/// Returns the RMS error of 12 fits with different seeds.
ErrorPoint by_paths(double share) {
  auto wanted = task(share);
  return rms_point(12, [&](unsigned seed) {
    wanted.paths.emplace().seed = seed;
    double paths = 0;
    OneRun run = timed_run(0, [&] {
      const mc::MediumFit fit = mc::fit_medium(wanted);
      paths = fit.paths;
      return relative_square(fit);
    });
    run.samples = paths;
    return run;
  });
}

/// Measures the error of fits by Monte Carlo; from point to point the assumed errors of the data
/// are halved. The search itself uses random paths and steps, so the slope differs from that of one
/// Monte Carlo sum.
ErrorCurve by_paths_against_time(double cpu_seconds) {
  ErrorCurve curve = empty_curve("paths");
  measure_points(curve, cpu_seconds, [share = 0.08]() mutable { return by_paths(share /= 2); });
  return curve;
}

}  // namespace

std::vector<ErrorRun> fit_error_runs() {
  constexpr bool slow = true;
  return {{"fit of a slab", "transport", by_transport, slow},
          {"fit of a slab", "paths", by_paths_against_time, slow}};
}

}  // namespace flatspeckle::bench
