#include "bench/error/error_varying.h"

#include <cmath>
#include <numbers>

#include "bench/error/error_paths.h"
#include "bench/error/error_slabs.h"
#include "mc/paths/dynamics/brownian.h"
#include "mc/slab/slab_covariance.h"

namespace flatspeckle::bench {

namespace {

constexpr double pi = std::numbers::pi, reference_tolerance = 1e-8;

SceneSpec slab() {
  SceneSpec spec = hg_slab();
  spec.view_angles = {-0.9, -0.4, 0.2, 0.8, pi - 0.6, pi - 0.2};
  return spec;
}

/// A uniform velocity turns the phase of what diffusion leaves.
struct Flow {
  Scene scene = make_scene(slab());
  std::vector<double> delays = {0.02, 0.05, 0.1};
  mc::Motion motion{.diffusion = 1, .velocity = {3, -2}};

  ErrorReference reference() const {
    ErrorReference found{{}, reference_tolerance, "transport"};
    const bool reversed = plan_of(scene).reversed;
    const auto add = [&](double delay) {
      const auto still =
          mc::slab_covariance(scene, reversed, {reference_tolerance}, {.delay = delay}).value;
      for (std::size_t e = 0; e < still.size(); ++e) {
        const auto [light, view] = scene.request.channels[scene.request.entries[e].a];
        const Vec2 turn = direction(scene.request.lights[light].angle) -
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
  const Method method{"slab_hg, flow", "ours", [](std::uint64_t seed) {
                        const Flow flow;
                        mc::Plan plan = plan_of(flow.scene);
                        plan.paths_per_batch = 50;
                        const auto job =
                            mc::delay_job(flow.scene, plan, flow.delays, seed, flow.motion);
                        return Trial{job.field.batches, job.all};
                      }};
  return {method.scene, method.name, [=](double cpu_seconds) {
            return measure_error(method, Flow().reference(), cpu_seconds);
          }};
}

}  // namespace

std::vector<ErrorRun> varying_error_runs() {
  return {flow_run()};
}

}  // namespace flatspeckle::bench
