#include "bench/error/error_slabs.h"

#include <cmath>
#include <numbers>

#include <omp.h>

#include "bench/error/error_paths.h"
#include "bench/oracles/discrete_ordinates.h"
#include "core/run/stopwatch.h"
#include "mc/slab/adding/space_scene.h"
#include "mc/slab/slab_covariance.h"

namespace flatspeckle::bench {

namespace {

constexpr double pi = std::numbers::pi;

SceneSpec slab() {
  SceneSpec spec = hg_slab();
  spec.view_angles = {-0.9, -0.7, -0.4, 0, 0.2, 0.5, 0.8, 1.1};
  spec.covariance = "memory_effect";
  spec.tilts = seven_tilts(3 / (2 * pi * 1000));  // q depth = 3
  return spec;
}

double two_terms(double angle) {
  return 0.9 * oracles::henyey_greenstein(0.8)(angle) +
         0.1 * oracles::henyey_greenstein(-0.4)(angle);
}

/// Of a phase function without a form of its own; intensities, which discrete ordinates know too.
SceneSpec two_term_slab() {
  SceneSpec spec = slab();
  spec.scatterer = "two_term_hg";
  spec.g = std::nullopt;
  std::get<TwoTermHg>(spec.bulk) = {0.8, -0.4, 0.9};
  spec.covariance = "intensity";
  spec.tilts = {};
  return spec;
}

/// The covariance to a tolerance.
using Transport = std::function<std::vector<Complex>(double tolerance)>;

Transport by_transport(const std::shared_ptr<const Scene>& scene) {
  const bool reversed = scene->medium.dimension == 2 && plan_of(*scene).reversed;
  return [=](double tolerance) { return mc::slab_covariance(*scene, reversed, {tolerance}).value; };
}

/// A slab, and tolerances of transport: of the reference, and the finest of the curve.
struct Slab {
  FlatScene flat;
  Transport transport;
  double reference_tolerance, finest_tolerance;

  ErrorReference reference() const {
    return {transport(reference_tolerance), reference_tolerance, "transport"};
  }
};

double cpu_seconds_of(const std::function<void()>& work) {
  constexpr double long_enough = 0.1;
  const double start = thread_cpu_seconds();
  int times = 0;
  double spent = 0;
  for (; spent < long_enough; ++times) {
    work();
    spent = thread_cpu_seconds() - start;
  }
  return spent / times;
}

/// No chance and no samples: a point per tolerance.
ErrorCurve transport_curve(const Slab& slab) {
  omp_set_num_threads(1);
  const ErrorReference reference = slab.reference();
  ErrorCurve curve{slab.flat.name, "transport", reference.how, reference.relative_error, {}};
  curve.is_monte_carlo = false;
  for (double tolerance = 1e-2; tolerance > 0.5 * slab.finest_tolerance; tolerance /= 10) {
    std::vector<Complex> found;
    const double seconds = cpu_seconds_of([&] { found = slab.transport(tolerance); });
    curve.points.push_back({seconds, 0, relative_distance(found, reference), 0});
  }
  return curve;
}

std::vector<ErrorRun> runs_on(const Slab& slab, const std::vector<Method>& methods) {
  std::vector<ErrorRun> runs;
  for (const Method& method : methods)
    runs.push_back(
        {method.scene, method.name,
         [=](double cpu_seconds) { return measure_error(method, slab.reference(), cpu_seconds); },
         method.slow});
  runs.push_back({slab.flat.name, "transport", [=](double) { return transport_curve(slab); },
                  slab.finest_tolerance > 1e-6});
  return runs;
}

std::vector<ErrorRun> plane_runs() {
  const FlatScene flat{"slab_hg", std::make_shared<const Scene>(make_scene(slab()))};
  return runs_on({flat, by_transport(flat.scene), 1e-10, 1e-8}, path_methods(flat));
}

std::vector<ErrorRun> space_runs() {
  const FlatScene flat{"slab_hg, in space",
                       std::make_shared<const Scene>(mc::in_space(make_scene(slab()), slab()))};
  return runs_on(
      {flat, by_transport(flat.scene), 1e-6, 1e-4},
      {{.scene = flat.name, .name = "ours", .trial = our_paths(flat.scene), .slow = true}});
}

ErrorReference discrete_ordinates(const SceneSpec& spec) {
  auto angles = spec.view_angles;
  angles.push_back(0);  // the light
  const oracles::SlabTransport theory({*spec.optical_depth, 1, two_terms}, angles, 100);
  ErrorReference reference{{}, 1e-5, "discrete ordinates, 100 a quadrant"};
  for (const double view : spec.view_angles)
    reference.value.emplace_back(theory.covariance_without_reversed(0, view));
  return reference;
}

ErrorRun two_term_run() {
  const SceneSpec spec = two_term_slab();
  const Method method{.scene = "slab_two_term_hg",
                      .name = "ours",
                      .trial = our_paths(std::make_shared<const Scene>(make_scene(spec)))};
  return {method.scene, method.name, [=](double cpu_seconds) {
            return measure_error(method, discrete_ordinates(spec), cpu_seconds);
          }};
}

}  // namespace

SceneSpec hg_slab() {
  SceneSpec spec;
  spec.domain = "slab";
  spec.depth = 1000;
  spec.scatterer = "hg";
  spec.g = 0.8;
  spec.optical_depth = 5;
  return spec;
}

std::vector<ErrorRun> slab_error_runs() {
  std::vector<ErrorRun> runs = plane_runs();
  runs.push_back(two_term_run());
  for (ErrorRun& run : space_runs()) runs.push_back(std::move(run));
  return runs;
}

}  // namespace flatspeckle::bench
