// What the hot parts cost, each beside what it replaces where there is such a thing. Compare rows
// of one run; absolute times say little on a shared machine.
#include <cmath>

#include <benchmark/benchmark.h>

#include "core/bessel.h"
#include "core/phasor.h"
#include "flatland/scene.h"
#include "mc/covariance_estimator.h"
#include "wave_solver/wave_solution.h"

using namespace flatspeckle;

namespace {

std::vector<double> distances(std::size_t n) {
  RandomStream random(1, 1, 0);
  std::vector<double> values(n);
  for (double& value : values) value = 200 * random.uniform();
  return values;
}

void hankel_order_0(benchmark::State& state) {
  const auto x = distances(1000);
  for (auto _ : state)
    for (double value : x) benchmark::DoNotOptimize(hankel0(value));
  state.SetItemsProcessed(state.iterations() * 1000);
}
BENCHMARK(hankel_order_0);

void glibc_j0_and_y0(benchmark::State& state) {
  const auto x = distances(1000);
  for (auto _ : state)
    for (double value : x) benchmark::DoNotOptimize(Complex(::j0(value), ::y0(value)));
  state.SetItemsProcessed(state.iterations() * 1000);
}
BENCHMARK(glibc_j0_and_y0);

void hankel_set_to_order_30(benchmark::State& state) {
  const auto x = distances(1000);
  std::vector<ExtendedComplex> h(31);
  for (auto _ : state)
    for (double value : x) hankel(value, h);
  state.SetItemsProcessed(state.iterations() * 1000);
}
BENCHMARK(hankel_set_to_order_30);

void phasors_vectorised(benchmark::State& state) {
  const auto phase = distances(1000);
  const std::vector<double> log_magnitude(1000, -1);
  std::vector<Complex> out(1000);
  for (auto _ : state) damped_phasors(phase, log_magnitude, out);
  state.SetItemsProcessed(state.iterations() * 1000);
}
BENCHMARK(phasors_vectorised);

void phasors_one_by_one(benchmark::State& state) {
  const auto phase = distances(1000);
  for (auto _ : state)
    for (double value : phase) benchmark::DoNotOptimize(std::polar(std::exp(-1.0), value));
  state.SetItemsProcessed(state.iterations() * 1000);
}
BENCHMARK(phasors_one_by_one);

/// Items: light paths.
void light_paths(benchmark::State& state, const SceneSpec& spec) {
  const Scene scene = make_scene(spec);
  const auto plan = mc::make_plan(scene, mc::ReversedPaths::automatic);
  const auto job = mc::covariance_job(scene, plan, 1).batches;
  std::vector<Complex> sums(job.size);
  std::uint64_t number = 0;
  for (auto _ : state) job.run(number++, sums);
  state.SetItemsProcessed(static_cast<std::int64_t>(number * plan.paths_per_batch));
}

SceneSpec box_points() {
  SceneSpec spec;
  spec.width = 20;
  spec.depth = 10;
  spec.count = 31;
  spec.view_angles = {0.1, 0.5, 0.8, 2.8, 3.1};
  spec.covariance = "memory_effect";
  spec.tilts = {0, 0.04, 0.16};
  return spec;
}

SceneSpec slab_hg() {
  SceneSpec spec;
  spec.domain = "slab";
  spec.scatterer = "hg";
  spec.g = 0.9;
  spec.depth = 1000;
  spec.optical_depth = 10;
  spec.covariance = "memory_effect";
  for (int t = 0; t < 33; ++t) spec.tilts.push_back(4e-5 * t);
  return spec;
}

BENCHMARK_CAPTURE(light_paths, box_points, box_points());
BENCHMARK_CAPTURE(light_paths, slab_hg, slab_hg());

/// One placement of points, 10 to the unit area, to its far field in one view.
void exact_points(benchmark::State& state) {
  SceneSpec spec = box_points();
  spec.width = spec.depth = std::sqrt(static_cast<double>(state.range(0)) / 10);
  spec.count = state.range(0);
  const Scene scene = make_scene(spec);
  RandomStream random(1, 1, 0);
  const auto placement = draw_placement(scene.domain, scene.scatterer, scene.placement, random);
  wave::SolveOptions options;
  options.diagnose = false;
  for (auto _ : state)
    benchmark::DoNotOptimize(wave::solve(placement, scene.k, {0}, options).far_field(0));
}
BENCHMARK(exact_points)->Arg(31)->Arg(250)->Arg(1000)->Unit(benchmark::kMillisecond);

}  // namespace
