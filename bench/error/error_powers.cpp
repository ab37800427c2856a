// Power that slabs reflect and transmit, in total, at distances from a beam, and by channels.

#include <cmath>
#include <memory>

#include <omp.h>

#include "bench/error/error_modules.h"
#include "mc/distance/distance_job.h"
#include "mc/paths/estimators/flux.h"
#include "mc/slab/adding/space.h"
#include "mc/slab/slab_flux.h"
#include "wave_solver/periodic/matrix_job.h"

namespace flatspeckle::bench {

namespace {

constexpr double slab_depth = 500, slab_g = 0.8;

SceneSpec forward_slab() {
  SceneSpec spec;
  spec.domain = "slab";
  spec.depth = slab_depth;
  spec.scatterer = "hg";
  spec.g = slab_g;
  spec.optical_depth = 5;
  spec.view_angles = {0};
  return spec;
}

ErrorRun flux_run() {
  const auto slab = std::make_shared<const Scene>(make_scene(forward_slab()));
  const ErrorMethod method{"slab, flux", "ours", [=](std::uint64_t seed) {
                             const mc::FluxJob job = mc::flux_job(*slab, 1, seed);
                             return ErrorTrial{job.batches, [](double samples, auto sums) {
                                                 return sample_mean(samples, sums.first(2));
                                               }};
                           }};
  return run_of(method, [=] {
    constexpr double tolerance = 1e-8;
    auto shares = mc::slab_flux(*slab, 1, {tolerance}).value;
    shares.resize(2);
    return ErrorReference{shares, tolerance, "transport"};
  });
}

/// Solves for the power on rings in space at 1 to 10 transport mean free paths from a beam.
std::vector<Complex> ring_powers(double tolerance) {
  SceneSpec spec = forward_slab();
  constexpr double optical_depth = 100, albedo = 0.999;
  spec.optical_depth = optical_depth;
  spec.albedo = albedo;
  const Scene slab = mc::in_space(make_scene(spec), spec);
  const double transport = slab_depth / (optical_depth * (1 - slab_g * albedo));
  mc::DistanceRequest request;
  for (const double distance : {1.0, 3.0, 10.0})
    request.detectors.push_back(
        {mc::DistanceDetector::Kind::ring, distance * transport, transport / 4});
  return mc::distance_solution(slab, request, tolerance).value;
}

ErrorCurve rings_by_tolerance(double) {
  omp_set_num_threads(1);
  constexpr double finest = 1e-7;
  const ErrorReference reference{ring_powers(finest), finest, "the solution to 1e-7"};
  ErrorCurve curve{"slab in space, power at distances",
                   "transport",
                   reference.how,
                   reference.relative_error,
                   {}};
  curve.is_monte_carlo = false;
  for (double tolerance = 1e-2; tolerance > 5e-6; tolerance /= 10) {
    const OneRun run =
        timed_run(0, [&] { return relative_distance(ring_powers(tolerance), reference); });
    curve.points.push_back({run.cpu_s, 0, run.square, 0});
  }
  return curve;
}

/// Estimates the conductance and the correlation of matrices shifted by one channel.
ErrorTrial matrices(std::uint64_t seed) {
  SceneSpec spec;
  spec.scatterer = "point";
  spec.width = 8.3;
  spec.depth = 5;
  spec.count = 40;
  wave::MatrixSettings settings{.shifts = 1, .segments = {}, .conjugated_fraction = {}};
  settings.options.tolerance = 1e-4;
  settings.options.diagnose = false;
  const auto job = wave::matrix_job(make_scene(spec), settings, seed);
  return {job.batches, [=](double samples, std::span<const Complex> sums) {
            GroupedSums all(sums.size());
            all.add(samples, sums);
            const auto found = wave::matrix_statistics(job, all);
            std::vector<Complex> values = found.tilt_correlation.value;
            values.front() = found.conductance.value.front();  // the correlation is 1 without shift
            return values;
          }};
}

constexpr const char* matrices_name = "matrices of a periodic slab";

ErrorRun matrix_run() {
  const ErrorMethod method{.scene = matrices_name,
                           .name = "placements",
                           .trial = matrices,
                           .first_point = 8};  // the first placement is solved twice
  return run_of(method, [] { return stored_reference(matrices_name); });
}

}  // namespace

std::vector<ErrorRun> power_error_runs() {
  return {flux_run(),
          {"slab in space, power at distances", "transport", rings_by_tolerance, false},
          matrix_run()};
}

std::vector<LongRun> power_long_runs() {
  return {{matrices_name, "long run of the same ensemble", matrices}};
}

}  // namespace flatspeckle::bench
