// Speckle of boxes and slabs.

#include <cmath>
#include <memory>
#include <numbers>

#include <omp.h>

#include "bench/error/error_modules.h"
#include "bench/oracles/discrete_ordinates.h"
#include "bench/oracles/textbook.h"
#include "core/run/stopwatch.h"
#include "mc/paths/dynamics/brownian.h"
#include "mc/paths/estimators/covariance_estimator.h"
#include "mc/paths/speckle/speckle_field.h"
#include "mc/slab/adding/space.h"
#include "mc/slab/slab_covariance.h"
#include "wave_solver/solutions/ensemble.h"

namespace flatspeckle::bench {

namespace {

using std::numbers::pi;

/// A scene and its name in the error curves.
struct FlatScene {
  std::string name;
  std::shared_ptr<const Scene> scene;
};

mc::Plan automatic_plan(const Scene& scene) {
  return mc::make_plan(scene, mc::ReversedPaths::automatic);
}

ErrorTrial trial_of(const FieldJob& job) {
  return {job.batches, job.covariance};
}

ErrorTrial textbook(const Scene& scene, std::uint64_t seed) {
  constexpr std::uint64_t paths = 50;
  return trial_of(oracles::textbook_job(scene, automatic_plan(scene).reversed, paths, seed));
}

ErrorTrial ours(const Scene& scene, std::uint64_t seed) {
  mc::Plan plan = automatic_plan(scene);
  plan.paths_per_batch = 50;
  return trial_of(mc::covariance_job(scene, plan, seed));
}

/// Estimates covariances from products of sampled fields: E[u_a u_b*] = C_ab for any number of
/// paths per field.
ErrorTrial fields(const Scene& scene, std::uint64_t seed) {
  constexpr std::uint64_t paths = 100;
  ErrorTrial trial{{}, sample_mean};
  trial.batches.size = scene.request.entries.size();
  trial.batches.run = [draw = mc::fields_by_paths(scene, automatic_plan(scene), seed, paths),
                       request = scene.request](std::uint64_t number, std::span<Complex> sums) {
    std::vector<Complex> field(request.channels.size());
    std::vector<double> intensity(field.size());
    draw(number, field, intensity);
    for (std::size_t i = 0; i < sums.size(); ++i)
      sums[i] += product_with_conjugate(field[request.entries[i].a], field[request.entries[i].b]);
  };
  return trial;
}

std::function<ErrorTrial(std::uint64_t seed)> by(const std::shared_ptr<const Scene>& scene,
                                                 ErrorTrial (*trial)(const Scene&, std::uint64_t)) {
  return [scene, trial](std::uint64_t seed) { return trial(*scene, seed); };
}

/// Returns 0 and six more angles, their sines equally spaced.
std::vector<double> seven_tilts(double largest_sine) {
  constexpr int count = 7;
  std::vector<double> angles;
  for (int t = 0; t < count; ++t) angles.push_back(std::asin(largest_sine * t / (count - 1)));
  return angles;
}

std::function<ErrorTrial(std::uint64_t seed)> our_paths(const std::shared_ptr<const Scene>& scene) {
  return by(scene, ours);
}

/// Returns the published Monte Carlo estimator, ours, and covariances from sampled speckle fields.
std::vector<ErrorMethod> path_methods(const FlatScene& flat) {
  return {{flat.name, "textbook Monte Carlo", by(flat.scene, textbook)},
          {flat.name, "ours", our_paths(flat.scene)},
          {flat.name, "fields", by(flat.scene, fields)}};
}

SceneSpec box(std::int64_t count) {
  SceneSpec spec;
  spec.width = 20;
  spec.depth = 10;
  spec.count = count;
  spec.view_angles = {-0.7, -0.4, 0.1, 0.5, 0.8, pi - 0.6, pi - 0.3, pi};
  spec.covariance = "memory_effect";
  spec.tilts = seven_tilts(0.18);  // C_I = 1/2 near 0.12
  return spec;
}

SceneSpec absorbing_box() {
  SceneSpec spec = box(39);
  spec.albedo = 0.8;
  return spec;
}

SceneSpec cylinders() {
  SceneSpec spec = box(67);
  // many directions, so that each of the expensive exact realizations contributes many speckles
  spec.view_angles = {-1.2, -1,  -0.8, -0.6,     -0.4,      -0.2,     0.1,      0.3,
                      0.5,  0.7, 0.9,  pi - 0.9, pi - 0.65, pi - 0.4, pi - 0.2, pi};
  spec.scatterer = "tm";
  spec.radius = 1 / (2 * pi);
  spec.index = "1.5";
  return spec;
}

/// Returns a box in space, seen out of the plane of incidence.
SceneSpec box_in_space(std::int64_t count) {
  SceneSpec spec = box(count);
  spec.dimension = 3;
  spec.height = spec.width;
  spec.view_azimuths = {0, 0.5, 1, 1.5, 2, 2.5, 3, 0};
  spec.tilt_azimuth = 0.7;
  return spec;
}

SceneSpec absorbing_box_in_space() {
  SceneSpec spec = box_in_space(1570);
  spec.albedo = 0.8;
  return spec;
}

SceneSpec spheres() {
  SceneSpec spec = box_in_space(1310);
  spec.scatterer = "penetrable";
  spec.radius = 1 / (2 * pi);
  spec.index = "2";
  return spec;
}

/// Returns a box in space that is small enough for exact ensembles.
SceneSpec small_box_in_space() {
  SceneSpec spec = box_in_space(100);
  spec.width = spec.height = 6;
  spec.depth = 4;
  return spec;
}

SceneSpec few_spheres() {
  SceneSpec spec = small_box_in_space();
  spec.count = 50;
  spec.scatterer = "penetrable";
  spec.radius = 1 / (2 * pi);
  spec.index = "2";
  return spec;
}

/// Returns boxes of optical depth about 1, in the plane and in space.
std::vector<FlatScene> scenes() {
  const auto shared = [](const SceneSpec& spec) {
    const Scene scene = make_scene(spec);
    return std::make_shared<const Scene>(spec.dimension == 3 ? mc::in_space(scene, spec) : scene);
  };
  return {{"box_points", shared(box(31))},
          {"box_points_absorbing", shared(absorbing_box())},
          {"box_cylinders", shared(cylinders())},
          {"box_points, in space", shared(box_in_space(1257))},
          {"box_points_absorbing, in space", shared(absorbing_box_in_space())},
          {"box_spheres, in space", shared(spheres())},
          {"box_100_points, in space", shared(small_box_in_space())},
          {"box_50_spheres, in space", shared(few_spheres())}};
}

/// The tolerance 1e-2 gives field errors of 3e-4, far below the error of any ensemble here.
ErrorTrial exact(const Scene& scene, wave::Method solver, std::uint64_t seed) {
  return trial_of(wave::wave_job(scene, seed, 1e-2, solver));
}

std::string exact_reference(const FlatScene& flat) {
  return flat.name + ", exact";
}

/// Returns exact ensembles by all solvers, except for large boxes in space. The first point has so
/// many placements n that 1/(n - 1) is nearly 1/n.
std::vector<ErrorMethod> exact_methods(const FlatScene& flat) {
  constexpr double most_in_space = 200;
  const bool in_space = flat.scene->medium.dimension == 3;
  if (in_space && flat.scene->placement.mean_count > most_in_space) return {};
  const bool is_expensive = flat.scene->scatterer.is_disk();
  const auto by = [&](const std::string& name, wave::Method solver) {
    return ErrorMethod{.scene = flat.name,
                       .name = name,
                       .trial = [scene = flat.scene, solver](
                                    std::uint64_t seed) { return exact(*scene, solver, seed); },
                       .first_point = is_expensive ? 16U : 64U,
                       .share = is_expensive ? 3.0 : 1.0,
                       .slow = is_expensive};
  };
  std::vector<ErrorMethod> methods{by("exact dense", wave::Method::dense)};
  if (!in_space) methods.push_back(by("exact fast", wave::Method::fast));
  return methods;
}

SceneSpec hg_slab() {
  SceneSpec spec;
  spec.domain = "slab";
  spec.depth = 1000;
  spec.scatterer = "hg";
  spec.g = 0.8;
  spec.optical_depth = 5;
  return spec;
}

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

/// A slab with a two-term phase function. Only intensities are requested, because discrete
/// ordinates provide a reference for them.
SceneSpec two_term_slab() {
  SceneSpec spec = slab();
  spec.scatterer = "two_term_hg";
  spec.g = std::nullopt;
  std::get<TwoTermHg>(spec.bulk) = {0.8, -0.4, 0.9};
  spec.covariance = "intensity";
  spec.tilts = {};
  return spec;
}

/// Returns the covariance to a tolerance.
using ToTolerance = std::function<std::vector<Complex>(double tolerance)>;

ToTolerance by_transport(const std::shared_ptr<const Scene>& scene) {
  const bool reversed = scene->medium.dimension == 2 && automatic_plan(*scene).reversed;
  return [=](double tolerance) { return mc::slab_covariance(*scene, reversed, {tolerance}).value; };
}

/// A slab with two tolerances of deterministic transport: that of the reference and the finest one
/// of the curve.
struct Slab {
  FlatScene flat;
  ToTolerance transport;
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

/// Measures deterministic transport: one point per tolerance, no samples.
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

std::vector<ErrorRun> runs_on(const Slab& slab, const std::vector<ErrorMethod>& methods) {
  std::vector<ErrorRun> runs;
  for (const ErrorMethod& method : methods)
    runs.push_back(run_of(method, [=] { return slab.reference(); }));
  runs.push_back({slab.flat.name, "transport", [=](double) { return transport_curve(slab); },
                  slab.finest_tolerance > 1e-6});
  return runs;
}

std::vector<ErrorRun> plane_runs() {
  const FlatScene flat{"slab_hg", std::make_shared<const Scene>(make_scene(slab()))};
  return runs_on({flat, by_transport(flat.scene), 1e-10, 1e-8}, path_methods(flat));
}

/// The slab behind faces of index 1.33.
std::vector<ErrorRun> faces_runs() {
  Scene scene = make_scene(slab());
  scene.faces = Faces{1.33, 1};
  const FlatScene flat{"slab_hg, faces", std::make_shared<const Scene>(scene)};
  return runs_on({flat, by_transport(flat.scene), 1e-10, 1e-8},
                 {{.scene = flat.name, .name = "ours", .trial = our_paths(flat.scene)}});
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
  angles.push_back(0);  // direction of the illumination
  const oracles::SlabTransport theory({*spec.optical_depth, 1, two_terms}, angles, 100);
  ErrorReference reference{{}, 1e-5, "discrete ordinates, 100 per quadrant"};
  for (const double view : spec.view_angles)
    reference.value.emplace_back(theory.covariance_without_reversed(0, view));
  return reference;
}

ErrorRun two_term_run() {
  const SceneSpec spec = two_term_slab();
  const ErrorMethod method{.scene = "slab_two_term_hg",
                           .name = "ours",
                           .trial = our_paths(std::make_shared<const Scene>(make_scene(spec)))};
  return run_of(method, [=] { return discrete_ordinates(spec); });
}

/// Scatterers that flow and diffuse. A uniform velocity only rotates the phase of the solution for
/// diffusion alone, which therefore serves as the reference.
struct Flow {
  Scene scene;
  std::vector<double> delays = {0.02, 0.05, 0.1};
  mc::Motion motion{.diffusion = 1, .velocity = {3, -2}};

  ErrorReference reference() const {
    constexpr double tolerance = 1e-8;
    ErrorReference found{{}, tolerance, "transport"};
    const bool reversed = automatic_plan(scene).reversed;
    const auto add = [&](double delay) {
      const auto still = mc::slab_covariance(scene, reversed, {tolerance}, {.delay = delay}).value;
      for (std::size_t e = 0; e < still.size(); ++e) {
        const auto [light, view] = scene.request.channels[scene.request.entries[e].a];
        const Vec turn = direction(scene.request.lights[light].angle) -
                         direction(scene.request.views[view].angle);
        found.value.push_back(std::polar(1.0, -scene.k * dot(turn, motion.velocity) * delay) *
                              still[e]);
      }
    };
    add(0);
    for (const double delay : delays) add(delay);
    return found;
  }
};

ErrorRun flow_run() {
  SceneSpec spec = hg_slab();
  spec.view_angles = {-0.9, -0.4, 0.2, 0.8, pi - 0.6, pi - 0.2};
  const Flow flow{make_scene(spec)};
  const ErrorMethod method{"slab_hg, flow", "ours", [=](std::uint64_t seed) {
                             mc::Plan plan = automatic_plan(flow.scene);
                             plan.paths_per_batch = 50;
                             const auto job =
                                 mc::delay_job(flow.scene, plan, flow.delays, seed, flow.motion);
                             return ErrorTrial{job.field.batches, job.all};
                           }};
  return run_of(method, [=] { return flow.reference(); });
}

}  // namespace

std::vector<ErrorRun> box_error_runs() {
  std::vector<ErrorRun> runs;
  for (const FlatScene& flat : scenes()) {
    const auto add = [&](const std::vector<ErrorMethod>& methods, const std::string& reference) {
      for (const ErrorMethod& method : methods)
        runs.push_back(run_of(method, [=] { return stored_reference(reference); }));
    };
    add(exact_methods(flat), exact_reference(flat));
    add(path_methods(flat), flat.name);
  }
  return runs;
}

std::vector<LongRun> box_long_runs() {
  std::vector<LongRun> runs;
  for (const FlatScene& flat : scenes()) {
    for (const ErrorMethod& method : exact_methods(flat))
      if (method.name == "exact dense")
        runs.push_back({exact_reference(flat), "long run of the exact ensemble by the dense solver",
                        method.trial});
    runs.push_back({flat.name, "long run of our Monte Carlo estimator", our_paths(flat.scene)});
  }
  return runs;
}

std::vector<ErrorRun> slab_error_runs() {
  std::vector<ErrorRun> runs = plane_runs();
  runs.push_back(two_term_run());
  for (auto* more : {faces_runs, space_runs})
    for (ErrorRun& run : more()) runs.push_back(std::move(run));
  runs.push_back(flow_run());
  return runs;
}

}  // namespace flatspeckle::bench
