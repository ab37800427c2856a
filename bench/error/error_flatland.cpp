#include "bench/error/error_flatland.h"

#include <cmath>
#include <memory>
#include <numbers>

#include "bench/error/error_exact.h"
#include "bench/oracles/discrete_ordinates.h"
#include "bench/oracles/textbook.h"
#include "flatland/scene/scene.h"
#include "mc/estimators/covariance_estimator.h"
#include "mc/space/space_scene.h"
#include "mc/speckle/speckle_field.h"

namespace flatspeckle::bench {

namespace {

constexpr double pi = std::numbers::pi;

std::vector<double> tilts(double largest_sine) {
  constexpr int count = 7;
  std::vector<double> angles;
  for (int t = 0; t < count; ++t) angles.push_back(std::asin(largest_sine * t / (count - 1)));
  return angles;
}

SceneSpec box(std::int64_t count) {
  SceneSpec spec;
  spec.width = 20;
  spec.depth = 10;
  spec.count = count;
  spec.view_angles = {-0.7, -0.4, 0.1, 0.5, 0.8, pi - 0.6, pi - 0.3, pi};
  spec.covariance = "memory_effect";
  spec.tilts = tilts(0.18);  // C_I = 1/2 near 0.12
  return spec;
}

SceneSpec absorbing_box() {
  SceneSpec spec = box(39);
  spec.albedo = 0.8;
  return spec;
}

SceneSpec cylinders() {
  SceneSpec spec = box(67);
  // many speckles, for exact realizations are dear
  spec.view_angles = {-1.2, -1,  -0.8, -0.6,     -0.4,      -0.2,     0.1,      0.3,
                      0.5,  0.7, 0.9,  pi - 0.9, pi - 0.65, pi - 0.4, pi - 0.2, pi};
  spec.scatterer = "tm";
  spec.radius = 1 / (2 * pi);
  spec.index = "1.5";
  return spec;
}

SceneSpec slab() {
  SceneSpec spec;
  spec.domain = "slab";
  spec.depth = 1000;
  spec.scatterer = "hg";
  spec.g = 0.8;
  spec.optical_depth = 5;
  spec.view_angles = {-0.9, -0.7, -0.4, 0, 0.2, 0.5, 0.8, 1.1};
  spec.covariance = "memory_effect";
  spec.tilts = tilts(3 / (2 * pi * 1000));  // q depth = 3
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

struct FlatScene {
  std::string name;
  std::shared_ptr<const Scene> scene;
};

std::vector<FlatScene> scenes() {
  const auto shared = [](const SceneSpec& spec) {
    return std::make_shared<const Scene>(make_scene(spec));
  };
  return {{"box_points", shared(box(31))},
          {"box_points_absorbing", shared(absorbing_box())},
          {"box_cylinders", shared(cylinders())},
          {"slab_hg", shared(slab())}};
}

bool is_box(const FlatScene& flat) {
  return flat.scene->domain.kind == Domain::Kind::box;
}

mc::Plan plan_of(const Scene& scene) {
  return mc::make_plan(scene, mc::ReversedPaths::automatic);
}

Trial trial_of(const FieldJob& job) {
  return {job.batches, job.covariance};
}

Trial exact(const Scene& scene, wave::Method solver, std::uint64_t seed) {
  return trial_of(exact_job(scene, solver, seed));
}

Trial textbook(const Scene& scene, std::uint64_t seed) {
  constexpr std::uint64_t paths = 50;
  return trial_of(oracles::textbook_job(scene, plan_of(scene).reversed, paths, seed));
}

Trial ours(const Scene& scene, std::uint64_t seed) {
  mc::Plan plan = plan_of(scene);
  plan.paths_per_batch = 50;
  return trial_of(mc::covariance_job(scene, plan, seed));
}

/// Products of drawn fields: E[u_a u_b*] = C_ab for any number of paths in a field.
Trial fields(const Scene& scene, std::uint64_t seed) {
  constexpr std::uint64_t paths = 100;
  Trial trial{{}, sample_mean};
  trial.batches.size = scene.request.entries.size();
  trial.batches.run = [draw = mc::fields_by_paths(scene, plan_of(scene), seed, paths),
                       request = scene.request](std::uint64_t number, std::span<Complex> sums) {
    std::vector<Complex> field(request.channels.size());
    std::vector<double> intensity(field.size());
    draw(number, field, intensity);
    for (std::size_t i = 0; i < sums.size(); ++i)
      sums[i] += product_with_conjugate(field[request.entries[i].a], field[request.entries[i].b]);
  };
  return trial;
}

std::string exact_reference(const FlatScene& flat) {
  return flat.name + ", exact";
}

/// Their first point has enough placements that 1/(n - 1) is nearly 1/n.
std::vector<Method> exact_methods(const FlatScene& flat) {
  const bool is_dear = flat.scene->scatterer.is_disk();
  const auto by = [&](const std::string& name, wave::Method solver) {
    return Method{.scene = flat.name,
                  .name = name,
                  .trial = [scene = flat.scene,
                            solver](std::uint64_t seed) { return exact(*scene, solver, seed); },
                  .first_point = is_dear ? 16U : 64U,
                  .share = is_dear ? 3.0 : 1.0,
                  .slow = is_dear};
  };
  return {by("exact dense", wave::Method::dense), by("exact fast", wave::Method::fast)};
}

std::vector<Method> random_path_methods(const FlatScene& flat) {
  const auto by = [scene = flat.scene](Trial (*trial)(const Scene&, std::uint64_t)) {
    return [scene, trial](std::uint64_t seed) { return trial(*scene, seed); };
  };
  return {{flat.name, "textbook Monte Carlo", by(textbook)},
          {flat.name, "ours", by(ours)},
          {flat.name, "fields", by(fields)}};
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
  const Method method{
      .scene = "slab_two_term_hg",
      .name = "ours",
      .trial = [scene = make_scene(spec)](std::uint64_t seed) { return ours(scene, seed); }};
  return {method.scene, method.name, [=](double cpu_seconds) {
            return measure_error(method, discrete_ordinates(spec), cpu_seconds);
          }};
}

/// The slab in space, by what transport has there.
ErrorRun space_run() {
  const SceneSpec spec = slab();
  const auto scene = std::make_shared<const Scene>(mc::in_space(make_scene(spec), spec));
  const Method method{.scene = "slab_hg, in space",
                      .name = "ours",
                      .trial = [scene](std::uint64_t seed) { return ours(*scene, seed); },
                      .slow = true};
  const auto run = [=](double cpu_seconds) {
    constexpr double tolerance = 1e-4;
    const auto request = mc::space_request(scene->request);
    const auto exact = mc::space_covariance(mc::space_slab(*scene), request, false, {tolerance});
    return measure_error(method, {exact.value, tolerance, "transport"}, cpu_seconds);
  };
  return {method.scene, method.name, run, method.slow};
}

ErrorRun run_of(const Method& method, const std::string& reference) {
  return {method.scene, method.name,
          [method, reference](double cpu_seconds) {
            return measure_error(method, stored_reference(reference), cpu_seconds);
          },
          method.slow};
}

}  // namespace

std::vector<ErrorRun> flatland_error_runs() {
  std::vector<ErrorRun> runs;
  for (const FlatScene& flat : scenes()) {
    if (is_box(flat))
      for (const Method& method : exact_methods(flat))
        runs.push_back(run_of(method, exact_reference(flat)));
    for (const Method& method : random_path_methods(flat))
      runs.push_back(run_of(method, flat.name));
  }
  runs.push_back(two_term_run());
  runs.push_back(space_run());
  return runs;
}

std::vector<LongRun> flatland_long_runs() {
  std::vector<LongRun> runs;
  for (const FlatScene& flat : scenes()) {
    if (is_box(flat))
      runs.push_back({exact_reference(flat), "long run of the exact ensemble by the dense solver",
                      exact_methods(flat).front().trial});
    runs.push_back({flat.name, "long run of our Monte Carlo estimator",
                    [scene = flat.scene](std::uint64_t seed) { return ours(*scene, seed); }});
  }
  return runs;
}

}  // namespace flatspeckle::bench
