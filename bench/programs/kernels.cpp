// Times the most expensive kernels, and the code that each of them replaced, if any. Compare CPU
// times within one run; absolute times mean little on a shared machine. To average out slow changes
// of the machine's speed, use --benchmark_enable_random_interleaving=true --benchmark_repetitions=9
#include <cmath>

#include <benchmark/benchmark.h>

#include "core/numbers/bessel.h"
#include "core/numbers/hankel_array.h"
#include "core/numbers/phasor.h"
#include "flatland/scene/scene.h"
#include "grin/render/flights/space.h"
#include "mc/paths/estimators/covariance_estimator.h"
#include "wave_solver/solutions/wave_solution.h"

using namespace flatspeckle;

namespace {

std::vector<double> distances(std::size_t n) {
  RandomStream random(1, 1, 0);
  std::vector<double> values(n);
  for (double& value : values) value = 200 * random.uniform();
  return values;
}

// Every second value is below 4, where another branch of the kernel is used.
std::vector<double> mixed_distances(std::size_t n) {
  auto values = distances(n);
  for (std::size_t i = 0; i < n; i += 2) values[i] /= 50;
  return values;
}

constexpr std::size_t many = 100'000;

void hankel_order_0(benchmark::State& state, const std::vector<double>& x) {
  std::vector<Complex> h(x.size());
  for (auto _ : state) hankel0(x, h);
  state.SetItemsProcessed(state.iterations() * x.size());
}

void glibc_j0_and_y0(benchmark::State& state, const std::vector<double>& x) {
  std::vector<Complex> h(x.size());
  for (auto _ : state)
    for (std::size_t i = 0; i < x.size(); ++i) h[i] = {::j0(x[i]), ::y0(x[i])};
  state.SetItemsProcessed(state.iterations() * x.size());
}

BENCHMARK_CAPTURE(hankel_order_0, uniform, distances(many));
BENCHMARK_CAPTURE(glibc_j0_and_y0, uniform, distances(many));
BENCHMARK_CAPTURE(hankel_order_0, mixed, mixed_distances(many));
BENCHMARK_CAPTURE(glibc_j0_and_y0, mixed, mixed_distances(many));

constexpr int set_order = 30;

void hankel_sets_to_30(benchmark::State& state) {
  const auto x = distances(1000);
  std::vector<double> re(x.size() * (set_order + 1)), im(re.size());
  for (auto _ : state) hankel_sets(x, set_order, re.data(), im.data());
  state.SetItemsProcessed(state.iterations() * x.size());
}
BENCHMARK(hankel_sets_to_30);

void hankel_sets_to_30_extended(benchmark::State& state) {
  const auto x = distances(1000);
  std::vector<ExtendedComplex> h(set_order + 1);
  for (auto _ : state)
    for (double value : x) hankel(value, h);
  state.SetItemsProcessed(state.iterations() * x.size());
}
BENCHMARK(hankel_sets_to_30_extended);

void hankel_sets_to_30_seeded_by_glibc(benchmark::State& state) {
  const auto x = distances(1000);
  std::vector<Complex> h(set_order + 1);
  for (auto _ : state)
    for (double value : x) {
      h[0] = {::j0(value), ::y0(value)};
      h[1] = {::j1(value), ::y1(value)};
      for (int n = 1; n < set_order; ++n) h[n + 1] = 2 * n / value * h[n] - h[n - 1];
      benchmark::DoNotOptimize(h.data());
    }
  state.SetItemsProcessed(state.iterations() * x.size());
}
BENCHMARK(hankel_sets_to_30_seeded_by_glibc);

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

/// One item is one light path.
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

/// Solves one placement of points, 10 per unit area, for its far field in one direction.
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

/// One item is one step of a ray.
template <class Integrator, class Field>
void ray_steps(benchmark::State& state, const Field& field) {
  constexpr int steps = 400;
  const auto start = grin::start_ray(field, grin::Vec3(0.1, 0.2, 0), grin::Vec3::UnitZ());
  for (auto _ : state) {
    grin::RayState ray = start;
    for (int i = 0; i < steps; ++i) Integrator::step(field, ray, 0.005);
    benchmark::DoNotOptimize(ray);
  }
  state.SetItemsProcessed(state.iterations() * steps);
}
const grin::StandingWave sound(0.33, 0.01, 0, 7, 4);
// The benchmark macro requires names without template arguments.
const auto leapfrog_steps = ray_steps<grin::Leapfrog, grin::StandingWave>;
const auto yoshida_steps = ray_steps<grin::Yoshida4, grin::StandingWave>;
const auto sharma_steps = ray_steps<grin::Sharma, grin::StandingWave>;
const auto fisheye_steps = ray_steps<grin::Sharma, grin::Fisheye>;
BENCHMARK_CAPTURE(leapfrog_steps, sound, sound);
BENCHMARK_CAPTURE(yoshida_steps, sound, sound);
BENCHMARK_CAPTURE(sharma_steps, sound, sound);
BENCHMARK_CAPTURE(fisheye_steps, fisheye, grin::Fisheye({0.33, 5}));

const grin::Stage foggy_ball{.boundary = grin::Sphere{}, .medium = {.mu_s = 2}};
const std::shared_ptr<const grin::Space> straight_fog =
    grin::make_space(grin::Homogeneous{}, foggy_ball);
const std::shared_ptr<const grin::Space> fisheye_fog =
    grin::make_space(grin::Fisheye({1, 1.5}), foggy_ball, {0.05, 8});

grin::PathPoint random_place(RandomStream& random) {
  const auto place = [&] { return random.uniform() - 0.5; };
  return {{place(), place(), place()}};
}

void flights(benchmark::State& state, const std::shared_ptr<const grin::Space>& space) {
  RandomStream random(1, 1, 0);
  for (auto _ : state)
    benchmark::DoNotOptimize(space->fly(random_place(random), grin::Vec3::UnitZ(), random));
}
BENCHMARK_CAPTURE(flights, straight, straight_fog);
BENCHMARK_CAPTURE(flights, fisheye, fisheye_fog);

void connections(benchmark::State& state, const std::shared_ptr<const grin::Space>& space) {
  RandomStream random(1, 1, 0);
  grin::ConnectionStatistics statistics;
  for (auto _ : state) {
    const grin::PathPoint from = random_place(random), to = random_place(random);
    benchmark::DoNotOptimize(space->connect(from, to, random, statistics));
  }
}
BENCHMARK_CAPTURE(connections, straight, straight_fog);
BENCHMARK_CAPTURE(connections, fisheye, fisheye_fog);

}  // namespace
