// Light through deep slabs, and back: CPU seconds of `render`, its pilot included, and of a plain
// photon program, to an error of 1 % of what comes through.
//
//   bench_deep_slab [photons of the plain program]
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <numbers>

#include "bench/oracles/slab_photons.h"
#include "core/run/stopwatch.h"
#include "grin/render/pictures/render_job.h"

using namespace flatspeckle;
using namespace flatspeckle::grin;
using oracles::SlabPhotons;

namespace {

constexpr double target = 0.01;

struct Timed {
  double through, error, back, cpu_s;
  double to_target() const { return cpu_s * std::pow(error / through / target, 2); }
};

void print(const char* name, const Timed& run) {
  std::printf("  %-14s through %.5g +- %.2g, back %.5g in %.3g s: %.3g s to 1 %%\n", name,
              run.through, run.error, run.back, run.cpu_s, run.to_target());
}

Timed counted(const SlabPhotons& slab, std::uint64_t photons) {
  const double start = thread_cpu_seconds();
  const auto shares = oracles::count_photons(slab, photons, 1);
  return {shares.transmitted, shares.transmitted_error, shares.reflected,
          thread_cpu_seconds() - start};
}

RenderScene scene_of(const SlabPhotons& slab) {
  const double half = 50 * slab.optical_depth;
  const auto face = [&](double z) {
    return AreaDetector{{0, 0, z}, Vec3::UnitY(), 2 * half, 2 * half, {}, std::numbers::pi / 2};
  };
  RenderScene scene{};
  scene.stage.boundary = Box{Vec3(-half, -half, 0), Vec3(half, half, slab.optical_depth)};
  scene.stage.medium.mu_s = slab.albedo;
  scene.stage.medium.mu_a = 1 - slab.albedo;
  scene.stage.medium.phase = {HgPhase{slab.g}};
  scene.lights = {BeamLight{{0, 0, 0}, Vec3::UnitZ(), 1e-3}};
  scene.sensors = {face(slab.optical_depth), face(0)};
  return scene;
}

Timed rendered(const SlabPhotons& slab, std::uint64_t seed) {
  const RenderScene scene = scene_of(slab);
  const double start = thread_cpu_seconds();
  const RenderJob job = render_job(scene, {}, seed);
  RunOptions options;
  options.stop.target_error = target;
  options.threads = 1;
  RunState state{GroupedSums(job.batches.size), {}};
  run_batches(job.batches, options, state);
  const Estimate found = rendered_picture(job, state.sums).steady;
  const double area = pixels_of(scene.sensors[0]).area;
  return {area * found.value[0].real(), area * found.error[0], area * found.value[1].real(),
          thread_cpu_seconds() - start};
}

}  // namespace

int main(int argc, char** argv) {
  const double photons = argc > 1 ? std::atof(argv[1]) : 1e6;
  for (const SlabPhotons& slab : {SlabPhotons{20, 0.9, 0}, {100, 1, 0.9}}) {
    std::printf("optical depth %g, albedo %g, g %g\n", slab.optical_depth, slab.albedo, slab.g);
    const double share = slab.albedo < 1 ? 1 : 0.05;  // longer walks
    print("photons", counted(slab, static_cast<std::uint64_t>(share * photons)));
    for (const std::uint64_t seed : {1, 2, 3}) print("render", rendered(slab, seed));
  }
  return 0;
}
