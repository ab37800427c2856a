#include "bench/error/error_render.h"

#include <memory>
#include <numbers>

#include "bench/oracles/guided_beam.h"
#include "bench/oracles/lamp_map.h"
#include "bench/oracles/peierls_slab.h"
#include "bench/scenes/meshes.h"
#include "bench/scenes/render_scenes.h"
#include "grin/render/pictures/map_datasets.h"

namespace flatspeckle::bench {

using grin::RenderMethod;
using grin::RenderScene;

namespace {

struct RenderScenePointer {
  std::string name;
  std::shared_ptr<const RenderScene> scene;
};

std::vector<RenderScenePointer> shared(const std::vector<NamedRender>& all) {
  std::vector<RenderScenePointer> scenes;
  for (const auto& [name, scene] : all)
    scenes.push_back({name, std::make_shared<const RenderScene>(scene)});
  return scenes;
}

Method method_of(const RenderScenePointer& named, const std::string& name, RenderMethod method) {
  return {.scene = named.name, .name = name, .trial = [scene = named.scene, method](auto seed) {
            const grin::RenderJob job = render_job(*scene, {method}, seed);
            return Trial{job.batches,
                         [pixels = job.pictures](double samples, std::span<const Complex> sums) {
                           return sample_mean(samples, sums.first(pixels));
                         }};
          }};
}

ErrorRun run_of(const Method& method, const std::function<ErrorReference()>& reference) {
  return {method.scene, method.name,
          [=](double cpu_seconds) { return measure_error(method, reference(), cpu_seconds); },
          method.slow};
}

Method photon_map(const RenderScenePointer& named) {
  Method method = method_of(named, "photon map, biased by its radius", RenderMethod::photon_map);
  method.is_monte_carlo = false;
  method.slow = named.name != "glass_ball";  // many photons, of many flights elsewhere
  return method;
}

/// Lambertian light of L/n^2 = 1 from all sides, no absorption: L/n^2 = 1 along every ray, so that
/// the irradiance is pi n^2, and n = 1 on the rim and around balls.
ErrorReference even_light(std::size_t pixels) {
  return {std::vector<Complex>(pixels, std::numbers::pi), 0, "closed form: irradiance pi"};
}

std::vector<ErrorRun> all_methods(const RenderScenePointer& named) {
  std::vector<ErrorRun> runs;
  const auto reference = [name = named.name] { return stored_reference(name); };
  std::vector<Method> methods{method_of(named, "path tracing", RenderMethod::path),
                              method_of(named, "light tracing", RenderMethod::light),
                              method_of(named, "bidirectional", RenderMethod::bidirectional),
                              photon_map(named)};
  const bool is_sound = named.name == "waveguide";
  if (is_sound) methods.push_back(method_of(named, "analog light paths", RenderMethod::analog));
  for (Method& method : methods) {
    if (is_sound) method.share = 2;  // long curved flights
    runs.push_back(run_of(method, reference));
  }
  return runs;
}

/// Path tracing finds the lamp wherever it goes: no variance, no curve.
std::vector<ErrorRun> closed_form(const RenderScenePointer& named) {
  std::vector<ErrorRun> runs;
  const auto reference = [scene = named.scene] {
    return even_light(render_job(*scene, {RenderMethod::light}, 0).pictures);
  };
  for (const Method& method :
       {method_of(named, "light tracing", RenderMethod::light),
        method_of(named, "bidirectional", RenderMethod::bidirectional), photon_map(named)})
    runs.push_back(run_of(method, reference));
  return runs;
}

/// What a ball of this radius leaves of a beam of radius 1 that it absorbs within a radius.
double left_by_ball(double radius) {
  constexpr double depth = 2;  // across the ball
  const double through = 2 * (1 - (1 + depth) * std::exp(-depth)) / (depth * depth);
  return 1 - radius * radius * (1 - through);
}

/// A ball of triangles, against the ball of its volume.
ErrorRun absorbing_ball() {
  const grin::LevelSurface ball = smooth(ball_mesh(5), 0.06);
  const double radius = std::cbrt(0.75 * ball.meant_volume() / std::numbers::pi);
  RenderScene scene{};
  scene.stage = {.boundary = grin::Box{{-1.5, -1.5, -1.5}, {1.5, 1.5, 1.5}},
                 .medium = {},
                 .bodies = {{ball, {.mu_a = 1 / radius}}}};
  scene.lights = {grin::BeamLight{{0, 0, -1.5}, grin::Vec3::UnitZ(), 1.2}};
  scene.sensors = {
      grin::AreaDetector{{0, 0, 1.5}, grin::Vec3::UnitY(), 3, 3, {}, std::numbers::pi / 2}};
  const RenderScenePointer named{"absorbing_ball", std::make_shared<const RenderScene>(scene)};
  return run_of(method_of(named, "ball of triangles", RenderMethod::light), [=] {
    return ErrorReference{{left_by_ball(radius / 1.2) / 9}, 0, "closed form, ball of its volume"};
  });
}

std::vector<ErrorRun> mesh_runs() {
  const RenderScenePointer ring{"ring_even", std::make_shared<const RenderScene>(even_ring())};
  const auto irradiance = [scene = ring.scene] {
    return even_light(render_job(*scene, {RenderMethod::light}, 0).pictures);
  };
  return {run_of(method_of(ring, "light tracing", RenderMethod::light), irradiance),
          run_of(method_of(ring, "bidirectional", RenderMethod::bidirectional), irradiance),
          absorbing_ball()};
}

/// Fluence in absorbing fog around a lamp.
ErrorRun map_run() {
  constexpr double albedo = 0.9;
  const auto scene = std::make_shared<const RenderScene>(oracles::lamp_map(albedo));
  const Method method{
      .scene = "lamp_in_fog", .name = "map of the fluence rate", .trial = [scene](auto seed) {
        const grin::RenderJob job = render_job(*scene, {}, seed);
        const std::size_t first = job.first_of_map(), cells = oracles::lamp_fluence(albedo).size();
        return Trial{job.batches, [=](double samples, std::span<const Complex> sums) {
                       return grin::map_means(samples, sums.subspan(first), cells);
                     }};
      }};
  return run_of(method, [] {
    const auto exact = oracles::lamp_fluence(albedo);
    return ErrorReference{{exact.begin(), exact.end()}, 0, "transport theory"};
  });
}

/// Transmittance of a slab that scatters as much as it absorbs, by mu_s and mu_a.
ErrorRun gradient_run() {
  RenderScene slab{};
  slab.step = 1;
  slab.max_length = 1e9;
  slab.stage = {.boundary = grin::Box{{-100, -100, 0}, {100, 100, 1}},
                .medium = {.mu_s = 1, .mu_a = 1}};
  slab.lights = {grin::BeamLight{{0, 0, 0}, grin::Vec3::UnitZ(), 0.01}};
  slab.sensors = {
      grin::AreaDetector{{0, 0, 1}, grin::Vec3::UnitY(), 200, 200, {}, std::numbers::pi / 2}};
  slab.bins.derivatives = 2;
  const Method method{
      .scene = "slab", .name = "derivatives by mu_s and mu_a", .trial = [slab](auto seed) {
        const grin::RenderJob job = render_job(slab, {RenderMethod::analog}, seed);
        return Trial{job.batches, [first = job.bins.first_derivative()](
                                      double samples, std::span<const Complex> sums) {
                       constexpr double area = 200 * 200;
                       return sample_mean(samples / area, sums.subspan(first, 2));
                     }};
      }};
  return run_of(method, [] {
    constexpr double apart = 1e-3;
    const auto through = [](double mu_s, double mu_a) {
      return oracles::isotropic_slab(mu_s + mu_a, mu_s / (mu_s + mu_a)).transmitted;
    };
    return ErrorReference{{(through(1 + apart, 1) - through(1 - apart, 1)) / (2 * apart),
                           (through(1, 1 + apart) - through(1, 1 - apart)) / (2 * apart)},
                          1e-5,
                          "differences of Peierls' equation"};
  });
}

/// A parabolic guide in fog that hardly turns light: what comes on a disk is what would without.
ErrorRun field_gradient_run() {
  constexpr double radius = 0.3, area = std::numbers::pi * radius * radius;
  const oracles::GuidedBeam beam{0.2, 6};
  grin::RenderValues guide = oracles::guided_values(beam, {radius}, 0.5, 1 - 1e-9);
  guide.gradient_by = {"alpha"};
  const RenderScene scene = make_render_scene(guide);
  const Method method{
      .scene = "parabolic guide", .name = "derivative by alpha", .trial = [scene](auto seed) {
        const grin::RenderJob job = render_job(scene, {RenderMethod::analog}, seed);
        constexpr int narrow = 2;  // of the widths of edges
        return Trial{job.batches, [first = job.bins.first_by_field() + narrow](
                                      double samples, std::span<const Complex> sums) {
                       return sample_mean(samples / area, sums.subspan(first, 1));
                     }};
      }};
  return run_of(method, [beam] {
    return ErrorReference{{beam.by_alpha(radius)}, 1e-5, "where rays of a parabolic guide go"};
  });
}

/// Joins by 1/r^2 without another strategy beside.
std::vector<ErrorRun> without_variance(const RenderScenePointer& named) {
  Method method = method_of(named, "path tracing, no finite variance", RenderMethod::path);
  method.is_monte_carlo = false;
  const auto reference = [name = named.name] { return stored_reference(name); };
  return {run_of(method, reference),
          run_of(method_of(named, "bidirectional", RenderMethod::bidirectional), reference)};
}

void append(std::vector<ErrorRun>& all, std::vector<ErrorRun> more) {
  for (ErrorRun& run : more) all.push_back(std::move(run));
}

}  // namespace

std::vector<ErrorRun> render_error_runs() {
  std::vector<ErrorRun> runs;
  for (const RenderScenePointer& named : shared(lamp_scenes())) append(runs, all_methods(named));
  append(runs,
         closed_form({"luneburg_even", std::make_shared<const RenderScene>(even_luneburg())}));
  append(runs, closed_form({"balls_even", std::make_shared<const RenderScene>(even_balls())}));
  append(runs, without_variance(
                   {"glass_ball_beam", std::make_shared<const RenderScene>(beam_on_glass_ball())}));
  append(runs, mesh_runs());
  runs.push_back(map_run());
  runs.push_back(gradient_run());
  runs.push_back(field_gradient_run());
  return runs;
}

std::vector<LongRun> render_long_runs() {
  std::vector<NamedRender> scenes = lamp_scenes();
  scenes.push_back({"glass_ball_beam", beam_on_glass_ball()});
  std::vector<LongRun> runs;
  for (const RenderScenePointer& named : shared(scenes)) {
    const bool by_light = named.name == "slab";  // five times as efficient there
    runs.push_back(
        {named.name,
         std::string("long run of ") + (by_light ? "light" : "bidirectional") + " tracing",
         method_of(named, "", by_light ? RenderMethod::light : RenderMethod::bidirectional).trial});
  }
  return runs;
}

}  // namespace flatspeckle::bench
