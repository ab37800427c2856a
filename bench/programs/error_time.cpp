// Error against run time of the exact ensemble and of Monte Carlo: box_points' medium at optical
// depths 1, 2, 4 in boxes of 20 x 10, 40 x 20, 80 x 40, intensities in six views. On one
// thread, the two in turn, every run with another seed. Writes every checkpoint as CSV to standard
// output; plots/methods_error_time.py draws it.
//
//   bench_error_time [runs [most seconds per run]] > data/methods_error_time.csv
#include <cstdio>
#include <cstdlib>
#include <numbers>

#include <omp.h>

#include "core/run/stopwatch.h"
#include "flatland/scene/scene.h"
#include "mc/paths/estimators/covariance_estimator.h"
#include "wave_solver/solutions/ensemble.h"

using namespace flatspeckle;

namespace {

constexpr double pi = std::numbers::pi;

Scene points(double depth, double optical_depth) {
  SceneSpec spec;
  spec.width = 2 * depth;
  spec.depth = depth;
  spec.optical_depth = optical_depth;  // a Poisson number of points
  spec.view_angles = {0.1, 0.5, 0.8, pi - 0.6, pi - 0.3, pi};
  return make_scene(spec);
}

FieldJob exact(const Scene& scene, std::uint64_t seed) {
  return wave::wave_job(scene, seed, 1e-6);
}

FieldJob monte_carlo(const Scene& scene, std::uint64_t seed) {
  mc::Plan plan = mc::make_plan(scene, mc::ReversedPaths::automatic);
  plan.paths_per_batch = 100;  // or the first checkpoint is past the target
  return mc::covariance_job(scene, plan, seed);
}

struct Method {
  const char* name;
  FieldJob (*job)(const Scene&, std::uint64_t seed);
  double target;  ///< relative error at which a run ends
};

struct Point {
  double depth, optical_depth;
};

void run(const Method& method, Point point, std::uint64_t seed, double seconds) {
  const Scene scene = points(point.depth, point.optical_depth);
  const double start = process_cpu_seconds();
  const FieldJob job = method.job(scene, seed);
  const double setup = process_cpu_seconds() - start;
  RunOptions options;
  options.stop.target_error = method.target;
  options.stop.seconds = seconds;
  options.threads = 1;
  RunState state;
  run_batches(job.batches, options, state);
  const Trace& trace = state.trace;
  for (std::size_t i = 0; i < trace.samples.size(); ++i)
    std::printf("%s,%llu,%g,%g,%g,%.4g,%.0f,%.4g,%.4g\n", method.name,
                static_cast<unsigned long long>(seed), scene.domain.width, point.depth,
                point.optical_depth, setup, trace.samples[i], trace.cpu_s[i],
                trace.relative_error[i]);
  std::fflush(stdout);
}

}  // namespace

int main(int argc, char** argv) {
  omp_set_num_threads(1);  // also while an estimator is set up
  const int runs = argc > 1 ? std::atoi(argv[1]) : 3;
  const double seconds = argc > 2 ? std::atof(argv[2]) : 60;
  std::printf(
      "# by bench_error_time: exact ensemble and Monte Carlo on box_points' medium, one thread\n"
      "method,seed,width,depth,optical_depth,setup_s,samples,cpu_s,relative_error\n");
  for (int seed = 1; seed <= runs; ++seed)
    for (double depth : {10.0, 20.0, 40.0})
      for (double optical_depth : {1.0, 2.0, 4.0})
        for (const Method& method : {Method{"wave", exact, 0.018}, {"mc", monte_carlo, 0.004}})
          run(method, {depth, optical_depth}, seed, seconds);
}
