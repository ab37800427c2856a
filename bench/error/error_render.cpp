#include <cmath>
#include <numbers>

#include "bench/baselines/photon_map.h"
#include "bench/error/error_modules.h"
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

using std::numbers::pi;

ErrorMethod method_of(const NamedRender& named, const std::string& name, RenderMethod method) {
  return {.scene = named.name, .name = name, .trial = [scene = named.scene, method](auto seed) {
            const grin::RenderJob job = render_job(scene, {method}, seed);
            return ErrorTrial{job.batches, [pixels = job.pictures](double samples,
                                                                   std::span<const Complex> sums) {
                                return sample_mean(samples, sums.first(pixels));
                              }};
          }};
}

/// Estimates `count` consecutive sums of a job, beginning with number first(bins), divided by an
/// area.
ErrorMethod sums_of(const std::string& scene, const std::string& name, const RenderScene& rendered,
                    std::size_t (*first)(const grin::TimeBins&), std::size_t count, double area) {
  return {.scene = scene, .name = name, .trial = [=](auto seed) {
            const grin::RenderJob job = render_job(rendered, {RenderMethod::forward}, seed);
            return ErrorTrial{job.batches, [=, at = first(job.bins)](
                                               double samples, std::span<const Complex> sums) {
                                return sample_mean(samples / area, sums.subspan(at, count));
                              }};
          }};
}

/// Makes the photon-map method. Callers choose the radius as a twentieth of the smallest length in
/// the scene: mean free paths and half widths of the stage and of bodies.
ErrorMethod photon_map(const NamedRender& named, double radius) {
  ErrorMethod method{.scene = named.name,
                     .name = "photon map, biased by its radius",
                     .trial = [scene = named.scene, radius](auto seed) {
                       return ErrorTrial{photon_map_job(scene, radius, seed), sample_mean};
                     }};
  method.is_monte_carlo = false;
  method.slow =
      named.name != "glass_ball";  // other scenes need many photons with many free flights
  return method;
}

/// Returns the reference for Lambertian light with L/n^2 = 1 from all sides on a scene without
/// absorption. L/n^2 = 1 along every ray, so the irradiance is pi n^2; it is pi because n = 1 at
/// the sensor (on the rim or around the balls).
ErrorReference even_light(const RenderScene& scene) {
  const auto pixels = static_cast<std::size_t>(grin::pixels_of(scene.sensors[0]).grid.count());
  return {std::vector<Complex>(pixels, pi), 0, "closed form: irradiance pi"};
}

void add_all_methods(std::vector<ErrorRun>& runs, const NamedRender& named, double radius) {
  std::vector<ErrorMethod> methods{method_of(named, "path tracing", RenderMethod::path),
                                   method_of(named, "light tracing", RenderMethod::light),
                                   method_of(named, "bidirectional", RenderMethod::bidirectional),
                                   photon_map(named, radius)};
  const bool is_sound = named.name == "waveguide";
  if (is_sound) methods.push_back(method_of(named, "analog light paths", RenderMethod::forward));
  for (ErrorMethod& method : methods) {
    if (is_sound) method.share = 2;  // long curved rays
    runs.push_back(run_of(method, [name = named.name] { return stored_reference(name); }));
  }
}

/// Adds a scene in isotropic illumination. Every camera path there ends with the same radiance, so
/// path tracing has no variance and is omitted.
void add_even_light(std::vector<ErrorRun>& runs, const NamedRender& named, double radius = 0) {
  std::vector<ErrorMethod> methods{method_of(named, "light tracing", RenderMethod::light),
                                   method_of(named, "bidirectional", RenderMethod::bidirectional)};
  if (radius > 0) methods.push_back(photon_map(named, radius));
  for (const ErrorMethod& method : methods)
    runs.push_back(run_of(method, [scene = named.scene] { return even_light(scene); }));
}

/// Returns the fraction of a beam of radius 1 that is not absorbed by a centred ball of this
/// radius, whose absorption length equals the radius.
double left_by_ball(double radius) {
  constexpr double depth = 2;  // optical depth across the ball
  const double through = 2 * (1 - (1 + depth) * std::exp(-depth)) / (depth * depth);
  return 1 - radius * radius * (1 - through);
}

/// Compares an absorbing ball of triangles with a sphere of equal volume.
ErrorRun absorbing_ball() {
  const grin::LevelSurface ball = smooth(ball_mesh(5), 0.06);
  const double radius = std::cbrt(0.75 * ball.meant_volume() / pi);
  RenderScene scene{};
  scene.stage = {.boundary = grin::Box{{-1.5, -1.5, -1.5}, {1.5, 1.5, 1.5}},
                 .medium = {},
                 .bodies = {{ball, {.mu_a = 1 / radius}}}};
  scene.lights = {grin::BeamLight{{0, 0, -1.5}, grin::Vec3::UnitZ(), 1.2}};
  scene.sensors = {grin::AreaDetector{{0, 0, 1.5}, grin::Vec3::UnitY(), 3, 3, {}, pi / 2}};
  return run_of(
      method_of({"absorbing_ball", scene}, "ball of triangles", RenderMethod::light), [=] {
        return ErrorReference{
            {left_by_ball(radius / 1.2) / 9}, 0, "closed form for a sphere of equal volume"};
      });
}

/// Measures the fluence rate in absorbing fog around a lamp.
ErrorRun map_run() {
  constexpr double albedo = 0.9;
  const RenderScene scene = oracles::lamp_map(albedo);
  const ErrorMethod method{
      .scene = "lamp_in_fog", .name = "map of the fluence rate", .trial = [scene](auto seed) {
        const grin::RenderJob job = render_job(scene, {}, seed);
        const std::size_t first = job.first_of_map(), cells = oracles::lamp_fluence(albedo).size();
        return ErrorTrial{job.batches, [=](double samples, std::span<const Complex> sums) {
                            return grin::map_means(samples, sums.subspan(first), cells);
                          }};
      }};
  return run_of(method, [] {
    const auto exact = oracles::lamp_fluence(albedo);
    return ErrorReference{{exact.begin(), exact.end()}, 0, "transport theory"};
  });
}

/// Measures the derivatives of a slab's transmittance with respect to mu_s and mu_a, at mu_s =
/// mu_a.
ErrorRun gradient_run() {
  RenderScene slab{};
  slab.step = 1;
  slab.max_length = 1e9;
  slab.stage = {.boundary = grin::Box{{-100, -100, 0}, {100, 100, 1}},
                .medium = {.mu_s = 1, .mu_a = 1}};
  slab.lights = {grin::BeamLight{{0, 0, 0}, grin::Vec3::UnitZ(), 0.01}};
  slab.sensors = {grin::AreaDetector{{0, 0, 1}, grin::Vec3::UnitY(), 200, 200, {}, pi / 2}};
  slab.bins.derivatives = 2;
  const auto first = [](const grin::TimeBins& bins) {
    return static_cast<std::size_t>(bins.first_derivative());
  };
  const ErrorMethod method =
      sums_of("slab", "derivatives by mu_s and mu_a", slab, first, 2, 200 * 200);
  return run_of(method, [] {
    constexpr double apart = 1e-3;
    const auto through = [](double mu_s, double mu_a) {
      return oracles::isotropic_slab(mu_s + mu_a, mu_s / (mu_s + mu_a)).transmitted;
    };
    return ErrorReference{{(through(1 + apart, 1) - through(1 - apart, 1)) / (2 * apart),
                           (through(1, 1 + apart) - through(1, 1 - apart)) / (2 * apart)},
                          1e-5,
                          "finite differences of solutions of Peierls' equation"};
  });
}

/// Measures the derivative of the power on a disk behind a parabolic guide. The fog in the guide
/// hardly deflects light, so the power is that without fog.
ErrorRun field_gradient_run() {
  constexpr double radius = 0.3;
  const oracles::GuidedBeam beam{0.2, 6};
  grin::RenderValues guide = oracles::guided_values(beam, {radius}, 0.5, 1 - 1e-9);
  guide.gradient_by = {"alpha"};
  const auto first = [](const grin::TimeBins& bins) {
    constexpr int narrow = 2;  // index in the list of edge widths
    return static_cast<std::size_t>(bins.first_by_field() + narrow);
  };
  return run_of(sums_of("parabolic guide", "derivative by alpha", make_render_scene(guide), first,
                        1, pi * radius * radius),
                [beam] {
                  return ErrorReference{
                      {beam.by_alpha(radius)}, 1e-5, "closed form of rays in a parabolic guide"};
                });
}

/// Measures the power on a disk at a distance in tissue.
ErrorRun far_disk_run() {
  constexpr double distance = 30, area = pi * 1.5 * 1.5;
  return run_of(method_of({"disk at 30 mm in tissue", tissue_disk(distance)}, "guided light paths",
                          RenderMethod::forward),
                [] {
                  return ErrorReference{{power_on_tissue_disk(distance) / area},
                                        1e-3,
                                        "harmonics at each transverse frequency (reflectance)"};
                });
}

/// Adds a scene in which path tracing has infinite variance: no competing strategy bounds the 1/r^2
/// singularity of its connections.
void add_without_variance(std::vector<ErrorRun>& runs, const NamedRender& named) {
  ErrorMethod path = method_of(named, "path tracing, no finite variance", RenderMethod::path);
  path.is_monte_carlo = false;
  for (const ErrorMethod& method :
       {path, method_of(named, "bidirectional", RenderMethod::bidirectional)})
    runs.push_back(run_of(method, [name = named.name] { return stored_reference(name); }));
}

}  // namespace

std::vector<ErrorRun> render_error_runs() {
  std::vector<ErrorRun> runs;
  const double radius[] = {0.05, 0.5, 0.05 / 0.51, 0.2};
  const auto lamps = lamp_scenes();
  for (std::size_t i = 0; i < lamps.size(); ++i) add_all_methods(runs, lamps[i], radius[i]);
  add_even_light(runs, {"luneburg_even", even_luneburg()}, 0.05);
  add_even_light(runs, {"balls_even", even_balls()}, 0.1);
  add_without_variance(runs, {"glass_ball_beam", beam_on_glass_ball()});
  add_even_light(runs, {"ring_even", even_ring()});
  for (const ErrorRun& run :
       {absorbing_ball(), map_run(), gradient_run(), field_gradient_run(), far_disk_run()})
    runs.push_back(run);
  return runs;
}

std::vector<LongRun> render_long_runs() {
  std::vector<NamedRender> scenes = lamp_scenes();
  scenes.push_back({"glass_ball_beam", beam_on_glass_ball()});
  std::vector<LongRun> runs;
  for (const NamedRender& named : scenes) {
    const bool by_light = named.name == "slab";  // light tracing is five times as efficient there
    runs.push_back(
        {named.name,
         std::string("long run of ") + (by_light ? "light" : "bidirectional") + " tracing",
         method_of(named, "", by_light ? RenderMethod::light : RenderMethod::bidirectional).trial});
  }
  return runs;
}

}  // namespace flatspeckle::bench
