#include <cmath>
#include <memory>
#include <utility>

#include "bench/oracles/lamp_map.h"
#include "bench/plan/plan_rooms.h"
#include "bench/plan/plan_timing.h"
#include "bench/scenes/meshes.h"
#include "bench/scenes/render_scenes.h"
#include "grin/render/methods/analog_light.h"
#include "grin/render/methods/path_kernels.h"
#include "grin/render/methods/tracer.h"
#include "grin/render/pictures/map_datasets.h"

namespace flatspeckle::bench {

namespace {

using namespace grin;

constexpr int paths_per_batch = 512;

std::shared_ptr<Transport> transport_in(const RenderScene& scene) {
  const double excess = std::get<Homogeneous>(scene.field).n_excess;
  const auto index = [&](const PathPoint& p) {
    return 1 + (p.part == scene.stage.field_part() ? excess : scene.stage.excess_in(p.part));
  };
  auto transport =
      std::make_shared<Transport>(Transport{.stage = scene.stage,
                                            .lights = Lights(scene.lights, scene.stage, index),
                                            .sensors = sensor_ends(scene.sensors, scene.stage)});
  transport->join_levels = {1e-3};
  return transport;
}

/// A kernel for straight rays, or one that solves for rays in a field that happens to be constant.
PathKernel path_kernel(const RenderPlan& plan, const std::shared_ptr<Transport>& transport,
                       const RenderScene& scene) {
  const double excess = std::get<Homogeneous>(scene.field).n_excess;
  if (!plan.curved) return path_kernel(plan, transport, make_space(scene.field, scene.stage));
  return path_kernel(
      plan, transport,
      make_space(ParabolicGuide({excess, 0}), scene.stage, {scene.step, scene.max_length}));
}

/// The steady picture, whatever its bins.
Estimator steady(std::size_t pixels) {
  return [pixels](double samples, std::span<const Complex> sums) {
    const std::size_t bins = sums.size() / pixels;
    std::vector<Complex> picture(pixels);
    for (std::size_t i = 0; i < sums.size(); ++i) picture[i / bins] += sums[i] / samples;
    return picture;
  };
}

SampledKernel kernel_of(const RenderPlan& plan, const RenderScene& scene,
                        const std::shared_ptr<Transport>& transport) {
  const int pixels = transport->pixels();
  const TimeBins bins = plan.timed ? TimeBins{0, 20, 50} : TimeBins{};
  const auto run = [=, paths = path_kernel(plan, transport, scene)](std::uint64_t number,
                                                                    std::span<Complex> sums) {
    Film film(pixels, bins, sums);
    RandomStream random(1, static_cast<std::uint64_t>(Stream::render), number);
    TransportCounts counts;
    paths(paths_per_batch, random, film, counts, nullptr);
  };
  const auto count = static_cast<std::size_t>(pixels);
  return {count * static_cast<std::size_t>(bins.sums()), paths_per_batch, run, steady(count)};
}

/// The kernel that a scene would have against the one that `generalise` makes of its plan.
PlanCase flag(const std::string& left_out, const std::string& name, const RenderScene& scene,
              Numbers numbers, void (*generalise)(RenderPlan&)) {
  return named("render", left_out, name, [=](double cpu_seconds) {
    PlanRow row{.per = "path"};
    const RenderPlan special = render_plan(scene);
    RenderPlan general = special;
    generalise(general);
    compare_sampled(row, kernel_of(general, scene, transport_in(scene)),
                    kernel_of(special, scene, transport_in(scene)), numbers, Measure::sample,
                    cpu_seconds);
    return row;
  });
}

SampledKernel map_of(const RenderScene& scene) {
  const RenderJob job = render_job(scene, {RenderMethod::light}, 1);
  const auto count = static_cast<std::size_t>(cells(*scene.map));
  return {job.batches.size, static_cast<double>(job.batches.samples_per_batch), job.batches.run,
          [=, first = job.first_of_map()](double samples, std::span<const Complex> sums) {
            return map_means(samples, sums.subspan(first), count);
          }};
}

/// A map beside a picture, and by itself.
PlanCase map_alone() {
  return named("render", "pictures", "map of the fluence around a lamp", [](double cpu_seconds) {
    PlanRow row{.per = "path"};
    const RenderScene alone = oracles::lamp_map(0.9);
    RenderScene both = alone;
    both.sensors = {Camera{Vec3(0, 0, 5), -Vec3::UnitZ(), Vec3::UnitY(), 1, {8, 8}}};
    compare_sampled(row, map_of(both), map_of(alone), Numbers::same, Measure::sample, cpu_seconds);
    return row;
  });
}

/// Light tracing through a slab, to an error of 1 % of what comes through.
PlanCase depth_in(const std::string& name, const RenderScene& scene) {
  return named("render", "importance in depth", name, [=](double cpu_seconds) {
    PlanRow row{.per = "1 % error"};
    const RenderRequest request{RenderMethod::light};
    const Tracers tracers(scene, request);
    const auto transport = tracers.make(RenderMethod::light).transport;
    RenderPlan general = tracers.plan();
    general.deep = false;
    compare_sampled(row, kernel_of(general, scene, transport),
                    kernel_of(tracers.plan(), scene, transport), Numbers::other, Measure::error,
                    cpu_seconds);
    return row;
  });
}

SampledKernel kernel_of(const Tracer& tracer) {
  const int pixels = tracer.transport->pixels();
  const auto run = [=](std::uint64_t number, std::span<Complex> sums) {
    Film film(pixels, {}, sums);
    RandomStream random(1, static_cast<std::uint64_t>(Stream::render), number);
    TransportCounts counts;
    tracer.add(paths_per_batch, random, film, counts);
  };
  const auto count = static_cast<std::size_t>(pixels);
  return {count, paths_per_batch, run, steady(count)};
}

SampledKernel powers_of(const RenderScene& scene) {
  const RenderJob job = render_job(scene, {RenderMethod::analog}, 1);
  const auto stride = static_cast<std::size_t>(scene.bins.sums());
  const std::size_t pixels = job.pictures / stride;
  return {job.batches.size, static_cast<double>(job.batches.samples_per_batch), job.batches.run,
          [=](double samples, std::span<const Complex> sums) {
            std::vector<Complex> picture;
            for (std::size_t i = 0; i < pixels; ++i) picture.push_back(sums[i * stride] / samples);
            return picture;
          }};
}

/// Rays of a beam, and beside them light paths, which bring nothing where nothing scatters.
PlanCase rays_alone() {
  return named("render", "light paths", "guide of sound, nothing scatters", [](double cpu_seconds) {
    PlanRow row{.per = "ray"};
    RenderScene scene = render_scenes()[1].scene;
    scene.stage.medium = {};
    const RenderRequest request{RenderMethod::analog};
    const Tracers tracers(scene, request);
    const Tracer special = tracers.make(RenderMethod::analog);
    Tracer general = special;
    const SpaceOptions options{scene.step, scene.max_length, Spreading::none};
    general.kernel =
        analog_kernel(special.transport, make_space(scene.field, scene.stage, options), {}, false);
    compare_sampled(row, kernel_of(general), kernel_of(special), Numbers::other, Measure::sample,
                    cpu_seconds);
    return row;
  });
}

/// Powers alone, and beside them their derivatives by the sound's amplitude.
PlanCase powers_alone() {
  return named("render", "derivatives by the field", "guide of sound in tissue",
               [](double cpu_seconds) {
                 PlanRow row{.per = "path"};
                 RenderScene powers = render_scenes()[1].scene;
                 powers.sensors = {RadialDetector{{0, 0, 30}, 0.2, 1, std::numbers::pi / 2}};
                 const auto& sound = std::get<StandingWave>(powers.field);
                 RenderScene both = powers;
                 constexpr double apart = 1e-5;
                 both.parameters = {{"amplitude", sound.amplitude(), apart * sound.amplitude(),
                                     sound.frozen(1 - apart), sound.frozen(1 + apart)}};
                 both.bins.by_field = edge_widths;
                 compare_sampled(row, powers_of(both), powers_of(powers), Numbers::same,
                                 Measure::sample, cpu_seconds);
                 return row;
               });
}

/// Light paths that scatter, to a small disk: most are given up, what heads for it is split.
PlanCase aimed_light() {
  return named(
      "render", "paths past a small sensor", "guide of sound in tissue", [](double cpu_seconds) {
        PlanRow row{.per = "1 % error"};
        RenderScene scene = render_scenes()[1].scene;
        scene.sensors = {RadialDetector{{0, 0, 30}, 0.2, 1, 1.5}};
        const RenderRequest request{RenderMethod::analog};
        const Tracers tracers(scene, request);
        const Tracer special = tracers.make(RenderMethod::analog);
        Tracer general = special;
        const SpaceOptions options{scene.step, scene.max_length, Spreading::none, scene.leapfrogs};
        general.kernel = analog_kernel(special.transport,
                                       make_space(scene.field, scene.stage, options), {}, false);
        compare_sampled(row, kernel_of(general), kernel_of(special), Numbers::other, Measure::error,
                        cpu_seconds);
        return row;
      });
}

SampledKernel kernel_of(const RenderJob& job) {
  const auto pixels = job.pictures / static_cast<std::size_t>(job.bins.sums());
  return {job.batches.size, static_cast<double>(job.batches.samples_per_batch), job.batches.run,
          [pixels, all = steady(pixels)](double samples, std::span<const Complex> sums) {
            return all(samples, sums.first(pixels));
          }};
}

/// The method that the pilot chooses, in place of the same for all scenes.
PlanCase chosen_over(RenderMethod other, const std::string& name, const RenderScene& scene) {
  return named("render", method_word(other) + " for all scenes", name, [=](double cpu_seconds) {
    PlanRow row{.per = "1 % error"};
    compare_sampled(row, kernel_of(render_job(scene, {other}, 1)),
                    kernel_of(render_job(scene, {}, 2)), Numbers::other, Measure::error,
                    cpu_seconds);
    return row;
  });
}

RenderScene absorbing_slab() {
  RenderScene scene{};
  scene.stage.boundary = Box{Vec3(-200, -200, 0), Vec3(200, 200, 10)};
  scene.stage.medium.mu_s = 0.9;
  scene.stage.medium.mu_a = 0.1;
  scene.lights = {BeamLight{{0, 0, 0}, {0, 0, 1}, 1}};
  scene.sensors = {AreaDetector{{0, 0, 10}, {0, 1, 0}, 400, 400, {}, 1.57}};
  return scene;
}

/// Scenes in which a method costs many times what another does, and in which another one does.
void add_choices(std::vector<PlanCase>& rows) {
  RenderScene fibre{};
  fibre.field = ParabolicGuide({.axis_excess = 0.6, .alpha = 0.5});
  fibre.step = 0.5;
  fibre.max_length = 1000;
  fibre.stage.boundary = Box{{-0.9, -0.9, 0}, {0.9, 0.9, 50}};
  fibre.lights = {FaceLight{{0, 0, 0}, 0.1}};
  fibre.sensors = {AreaDetector{{0, 0, 50}, {0, 1, 0}, 1, 1, {}, 0.5}};
  RenderScene slab = lamp_scenes()[2].scene;
  std::get<AreaDetector>(slab.sensors[0]).pixels = {1, 1};
  for (const auto other : {RenderMethod::path, RenderMethod::light, RenderMethod::bidirectional}) {
    rows.push_back(chosen_over(other, "clear fibre", fibre));
    rows.push_back(chosen_over(other, "slab of OD 5", slab));
  }
}

/// A ball by its equation, and as triangles.
PlanCase ball_of_triangles(const std::string& name, RenderScene scene) {
  return named("render", "triangles", name, [=](double cpu_seconds) {
    PlanRow row{.per = "path"};
    RenderScene general = scene;
    general.stage.bodies[0].surface = smooth(ball_mesh(4), 0.1);
    const RenderPlan plan = render_plan(scene);
    compare_sampled(row, kernel_of(plan, general, transport_in(general)),
                    kernel_of(plan, scene, transport_in(scene)), Numbers::other, Measure::sample,
                    cpu_seconds);
    return row;
  });
}

}  // namespace

std::vector<PlanCase> render_plan_cases() {
  RenderScene fog = foggy_ball();
  fog.sensors = {AreaDetector{{0, 0, 3}, {0, 1, 0}, 6, 6, {4, 4}, 1.5}};
  RenderScene clear = fog, alone = fog;
  clear.stage.medium = clear.stage.bodies[0].medium = {};
  clear.lights = {FaceLight{.radius = INFINITY}};  // what a beam sheds unscattered is summed apart
  alone.stage.bodies = {};
  alone.stage.medium.mu_s = 1;
  constexpr auto same = Numbers::same, other = Numbers::other;
  const std::string box = "box of fog";
  std::vector<PlanCase> rows{
      flag("curved rays", box, alone, other, [](RenderPlan& p) { p.curved = true; }),
      flag("time bins", box, alone, same, [](RenderPlan& p) { p.timed = true; }),
      rays_alone(),
      aimed_light(),
      powers_alone(),
      depth_in("slab of OD 10, albedo 0.9", absorbing_slab()),
      map_alone(),
      ball_of_triangles("ball of fog", fog),
      ball_of_triangles("clear ball in a box", clear)};
  add_choices(rows);
  return rows;
}

}  // namespace flatspeckle::bench
