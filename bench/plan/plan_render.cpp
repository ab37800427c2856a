#include <cmath>
#include <memory>

#include "bench/oracles/lamp_map.h"
#include "bench/plan/plan_timing.h"
#include "bench/scenes/meshes.h"
#include "bench/scenes/render_scenes.h"
#include "grin/render/methods/forward_light.h"
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
  auto transport = std::make_shared<Transport>(
      Transport{.stage = scene.stage,
                .lights = {scene.lights, scene.stage, index},
                .sensors = sensor_endpoints(scene.sensors, scene.stage)});
  transport->connection_levels = {1e-3};
  return transport;
}

/// Makes a kernel for straight rays, or one that traces curved rays in a constant field.
PathKernel path_kernel(const RenderPlan& plan, const std::shared_ptr<Transport>& transport,
                       const RenderScene& scene) {
  const double excess = std::get<Homogeneous>(scene.field).n_excess;
  if (!plan.curved) return path_kernel(plan, transport, make_space(scene.field, scene.stage));
  return path_kernel(
      plan, transport,
      make_space(ParabolicGuide({excess, 0}), scene.stage, {scene.step, scene.max_length}));
}

/// Returns an estimator of the time-integrated picture, for any number of time bins.
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

SampledKernel kernel_of(const RenderJob& job, const Estimator& estimator) {
  return {job.batches.size, static_cast<double>(job.batches.samples_per_batch), job.batches.run,
          estimator};
}

/// Makes a kernel that estimates the power on each pixel and ignores all other sums.
SampledKernel powers_of(const RenderJob& job) {
  const auto stride = static_cast<std::size_t>(job.bins.sums());
  return kernel_of(job, [=, all = job.pictures](double samples, std::span<const Complex> sums) {
    std::vector<Complex> picture;
    for (std::size_t i = 0; i < all; i += stride) picture.push_back(sums[i] / samples);
    return picture;
  });
}

SampledKernel map_of(const RenderScene& scene) {
  const RenderJob job = render_job(scene, {RenderMethod::light}, 1);
  return kernel_of(
      job, [first = job.first_of_map(), count = static_cast<std::size_t>(cells(*scene.map))](
               double samples, std::span<const Complex> sums) {
        return map_means(samples, sums.subspan(first), count);
      });
}

/// Compares a scene's own kernel with the one that `generalise` makes of its plan.
PlanCase flag(const std::string& left_out, const std::string& name, const RenderScene& scene,
              Draws numbers, void (*generalise)(RenderPlan&)) {
  return case_of_samples({"render", left_out, name, "path"}, numbers, Measure::sample,
                         [=]() -> TwoKernels {
                           const RenderPlan special = render_plan(scene);
                           RenderPlan general = special;
                           generalise(general);
                           return {kernel_of(general, scene, transport_in(scene)),
                                   kernel_of(special, scene, transport_in(scene))};
                         });
}

/// Compares a run that makes a map and a picture with a run that makes the map alone.
TwoKernels map_alone() {
  const RenderScene alone = oracles::lamp_map(0.9);
  RenderScene both = alone;
  both.sensors = {Camera{Vec3(0, 0, 5), -Vec3::UnitZ(), Vec3::UnitY(), 1, {4, 4}}};
  return {map_of(both), map_of(alone)};
}

/// Compares light tracing through a slab without and with importance as a function of depth.
TwoKernels depth_alone() {
  RenderScene scene{};
  scene.stage.boundary = Box{Vec3(-200, -200, 0), Vec3(200, 200, 10)};
  scene.stage.medium = fog(0.9, 0.1, 0);
  scene.lights = {BeamLight{{0, 0, 0}, {0, 0, 1}, 1}};
  scene.sensors = {AreaDetector{{0, 0, 10}, {0, 1, 0}, 400, 400, {}, 1.57}};
  const RenderRequest request{RenderMethod::light};
  const Tracers tracers(scene, request);
  const auto transport = tracers.make(RenderMethod::light).transport;
  RenderPlan general = tracers.plan();
  general.deep = false;
  return {kernel_of(general, scene, transport), kernel_of(tracers.plan(), scene, transport)};
}

/// Compares forward tracing with and without light paths that are not directed at the sensor.
TwoKernels forward_light(const RenderScene& scene) {
  const RenderRequest request{RenderMethod::forward};
  const Tracer special = Tracers(scene, request).make(RenderMethod::forward);
  Tracer general = special;
  const SpaceOptions options{scene.step, scene.max_length, Spreading::none, scene.leapfrogs};
  general.kernel =
      forward_kernel(special.transport, make_space(scene.field, scene.stage, options), {}, false);
  return {kernel_of(general), kernel_of(special)};
}

/// Compares the rays of a beam with and without light paths, which contribute nothing because the
/// medium does not scatter.
TwoKernels rays_alone() {
  RenderScene scene = waveguide();
  scene.stage.medium = {};
  return forward_light(scene);
}

/// Compares scattered light paths to a small disk. The specialised kernel terminates most of them
/// and splits those directed at the disk.
TwoKernels light_to_small_disk() {
  RenderScene scene = waveguide();
  scene.sensors = {RadialDetector{{0, 0, 30}, 0.2, 1, 1.5}};
  return forward_light(scene);
}

/// Compares light paths to a disk at a distance in tissue. The specialised kernel guides them and
/// turns them about the beam.
TwoKernels light_to_far_disk() {
  return forward_light(tissue_disk(8));
}

/// Compares powers with and without their derivatives with respect to the amplitude of the sound.
TwoKernels powers_alone() {
  RenderScene powers = waveguide();
  powers.sensors = {RadialDetector{{0, 0, 30}, 0.2, 1, std::numbers::pi / 2}};
  const auto& sound = std::get<StandingWave>(powers.field);
  RenderScene both = powers;
  constexpr double apart = 1e-5;
  both.parameters = {{"amplitude", sound.amplitude(), apart * sound.amplitude(),
                      sound.frozen(1 - apart), sound.frozen(1 + apart)}};
  both.bins.by_field = edge_widths;
  const auto forward = [](const RenderScene& scene) {
    return powers_of(render_job(scene, {RenderMethod::forward}, 1));
  };
  return {forward(both), forward(powers)};
}

/// Adds scenes whose best method differs from scene to scene, by a large factor in efficiency. The
/// method chosen by the pilot run is compared with one method for all scenes.
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
  for (const auto other : {RenderMethod::path, RenderMethod::light, RenderMethod::bidirectional})
    for (const auto& [name, scene] : {NamedRender{"clear fibre", fibre}, {"slab of OD 5", slab}})
      rows.push_back(case_of_samples(
          {"render", method_word(other) + " for all scenes", name, ""}, Draws::other,
          Measure::error, [other, scene = scene]() -> TwoKernels {
            return {powers_of(render_job(scene, {other}, 1)), powers_of(render_job(scene, {}, 2))};
          }));
}

/// Compares a ball of triangles with one given by its equation.
PlanCase ball_of_triangles(const std::string& name, const RenderScene& scene) {
  return case_of_samples({"render", "triangles", name, "path"}, Draws::other, Measure::sample,
                         [=]() -> TwoKernels {
                           RenderScene general = scene;
                           general.stage.bodies[0].surface = smooth(ball_mesh(4), 0.1);
                           const RenderPlan plan = render_plan(scene);
                           return {kernel_of(plan, general, transport_in(general)),
                                   kernel_of(plan, scene, transport_in(scene))};
                         });
}

/// Returns a scene with a glass ball under a beam, with fog inside and outside the ball.
RenderScene foggy_ball() {
  RenderScene scene{};
  scene.field = Homogeneous{0.5};
  scene.step = 0.1;
  scene.max_length = 100;
  scene.stage.boundary = Box{{-3, -3, -3}, {3, 3, 3}};
  scene.stage.medium = fog(0.2, 0, 0.5);
  scene.stage.bodies.push_back({Sphere{}, fog(0.5, 0, 0.5)});
  scene.lights = {BeamLight{{0, 0, -3}, {0, 0, 1}, 0.8}};
  scene.sensors = {AreaDetector{{0, 0, 3}, {0, 1, 0}, 6, 6, {4, 4}, 1.5}};
  return scene;
}

}  // namespace

std::vector<PlanCase> render_plan_cases() {
  const RenderScene ball = foggy_ball();
  RenderScene clear = ball, alone = ball;
  clear.stage.medium = clear.stage.bodies[0].medium = {};
  clear.lights = {
      FaceLight{.radius = INFINITY}};  // unscattered light of a beam is summed separately
  alone.stage.bodies = {};
  alone.stage.medium.mu_s = 1;
  constexpr auto same = Draws::same, other = Draws::other;
  constexpr auto sample = Measure::sample, error = Measure::error;
  const std::string box = "box of fog";
  std::vector<PlanCase> rows{
      flag("curved rays", box, alone, other, [](RenderPlan& p) { p.curved = true; }),
      flag("time bins", box, alone, same, [](RenderPlan& p) { p.timed = true; }),
      case_of_samples({"render", "light paths", "guide of sound, nothing scatters", "ray"}, other,
                      sample, rays_alone),
      case_of_samples({"render", "paths past a small sensor", "guide of sound in tissue", ""},
                      other, error, light_to_small_disk),
      case_of_samples({"render", "paths past a far sensor", "disk at 8 mm in tissue", ""}, other,
                      error, light_to_far_disk),
      case_of_samples({"render", "derivatives by the field", "guide of sound in tissue", "path"},
                      same, sample, powers_alone),
      case_of_samples({"render", "importance in depth", "slab of OD 10, albedo 0.9", ""}, other,
                      error, depth_alone),
      case_of_samples({"render", "pictures", "map of the fluence around a lamp", "path"}, same,
                      sample, map_alone),
      ball_of_triangles("ball of fog", ball),
      ball_of_triangles("clear ball in a box", clear)};
  add_choices(rows);
  return rows;
}

}  // namespace flatspeckle::bench
