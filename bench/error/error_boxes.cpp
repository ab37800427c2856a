#include "bench/error/error_boxes.h"

#include <numbers>

#include "bench/error/error_exact.h"
#include "bench/error/error_paths.h"

namespace flatspeckle::bench {

namespace {

constexpr double pi = std::numbers::pi;

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
  // many speckles, for exact realizations are dear
  spec.view_angles = {-1.2, -1,  -0.8, -0.6,     -0.4,      -0.2,     0.1,      0.3,
                      0.5,  0.7, 0.9,  pi - 0.9, pi - 0.65, pi - 0.4, pi - 0.2, pi};
  spec.scatterer = "tm";
  spec.radius = 1 / (2 * pi);
  spec.index = "1.5";
  return spec;
}

std::vector<FlatScene> scenes() {
  const auto shared = [](const SceneSpec& spec) {
    return std::make_shared<const Scene>(make_scene(spec));
  };
  return {{"box_points", shared(box(31))},
          {"box_points_absorbing", shared(absorbing_box())},
          {"box_cylinders", shared(cylinders())}};
}

Trial exact(const Scene& scene, wave::Method solver, std::uint64_t seed) {
  return trial_of(exact_job(scene, solver, seed));
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

ErrorRun run_of(const Method& method, const std::string& reference) {
  return {method.scene, method.name,
          [method, reference](double cpu_seconds) {
            return measure_error(method, stored_reference(reference), cpu_seconds);
          },
          method.slow};
}

}  // namespace

std::vector<ErrorRun> box_error_runs() {
  std::vector<ErrorRun> runs;
  for (const FlatScene& flat : scenes()) {
    for (const Method& method : exact_methods(flat))
      runs.push_back(run_of(method, exact_reference(flat)));
    for (const Method& method : path_methods(flat)) runs.push_back(run_of(method, flat.name));
  }
  return runs;
}

std::vector<LongRun> box_long_runs() {
  std::vector<LongRun> runs;
  for (const FlatScene& flat : scenes()) {
    runs.push_back({exact_reference(flat), "long run of the exact ensemble by the dense solver",
                    exact_methods(flat).front().trial});
    runs.push_back({flat.name, "long run of our Monte Carlo estimator", our_paths(flat.scene)});
  }
  return runs;
}

}  // namespace flatspeckle::bench
