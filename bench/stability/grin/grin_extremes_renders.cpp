// Renderings of extreme scenes: the white furnace, and extremely thin, deep and forward-scattering
// slabs.

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include "bench/oracles/guided_beam.h"
#include "bench/oracles/lamp_map.h"
#include "bench/oracles/peierls_slab.h"
#include "bench/scenes/furnaces.h"
#include "bench/scenes/render_scenes.h"
#include "bench/stability/extreme_rows.h"
#include "grin/media/scattering/labelled_media.h"
#include "grin/render/pictures/map_datasets.h"
#include "grin/render/pictures/render_datasets.h"
#include "grin/render/transport/path_score.h"

namespace flatspeckle::bench {

namespace {

using namespace grin;
using namespace oracles;
using std::numbers::pi;

struct Rendering {
  Estimate pixels;
  TransportCounts counts;
};
RunState run_state(const RenderJob& job, std::uint64_t samples) {
  RunOptions options;
  options.stop.samples = samples;
  options.threads = 1;
  RunState state;
  run_batches(job.batches, options, state);
  return state;
}
/// Rendering method; nullopt if the pilot run chooses it.
using Chosen = std::optional<RenderMethod>;
Rendering rendered(const RenderScene& scene, Chosen method, std::uint64_t samples) {
  const RenderJob job = render_job(scene, {method}, 1);
  const GroupedSums sums = run_state(job, samples).sums;
  return {rendered_picture(job, sums).steady, transport_counts(job, sums)};
}

/// Checks the white furnace (C24): the irradiance is pi times the mean of n^2 over the face at z =
/// 1, and a camera inside measures 1.
Finding furnace(RenderScene scene, std::uint64_t samples) {
  const double expected = pi * mean_square_index(scene);
  const Rendering face = rendered(scene, RenderMethod::bidirectional, samples);
  Finding worst = in_errors(face.pixels.value[0], face.pixels.error[0], expected, 0.1);
  scene.sensors = {Camera{Vec3(0.2, -0.1, -0.8), Vec3::UnitZ(), Vec3::UnitY(), 1.2, {1, 1}}};
  const Rendering inside = rendered(scene, RenderMethod::path, samples);
  // without absorption every path returns exactly the radiance of the environment, so the error may
  // be 0
  const double error = std::max(inside.pixels.error[0], 1e-12);
  worst = worse(worst, in_errors(inside.pixels.value[0], error, 1, 0.1));
  if (face.counts.lost_values + inside.counts.lost_values > 0) return {1, 0};
  return worst;
}

RenderScene in_box(AnyIndexField field, const ScatteringMedium& medium) {
  return scene_in(std::move(field), {unit_box(), medium}, environment(), whole_face());
}

/// Checks that every pixel of a picture of an even environment is 1, with error 0.
Finding even_picture(RenderScene scene, std::uint64_t samples) {
  scene.sensors = {Camera{Vec3(0.2, -0.1, -0.8), Vec3::UnitZ(), Vec3::UnitY(), 1.2, {61, 47}}};
  const Estimate pixels = rendered(scene, std::nullopt, samples).pixels;
  double worst = 0;
  for (std::size_t i = 0; i < pixels.value.size(); ++i)
    worst = std::max(worst, std::abs(pixels.value[i] - 1.0) + pixels.error[i]);
  return {worst, 1e-12};
}

/// A slab of matched index and thickness 1 under a thin beam, with a detector that covers a face.
RenderScene slab(const ScatteringMedium& medium, bool reflected) {
  RenderScene scene{};
  scene.step = 1;
  scene.max_length = 1e9;
  scene.stage.boundary = Box{Vec3(-100, -100, 0), Vec3(100, 100, 1)};
  scene.stage.medium = medium;
  scene.lights = {BeamLight{{0, 0, 0}, {0, 0, 1}, 0.01}};
  scene.sensors = {AreaDetector{{0, 0, reflected ? 0. : 1.}, {0, 1, 0}, 200, 200, {}, pi / 2}};
  return scene;
}

Estimate times(double factor, Estimate all) {
  for (Complex& value : all.value) value *= factor;
  for (double& error : all.error) error *= factor;
  return all;
}

/// Checks the power that reaches a face from a beam of power 1.
Finding share_row(const ScatteringMedium& medium, bool reflected, Chosen method,
                  std::uint64_t samples, double expected, double largest_error,
                  double accuracy = 0) {
  const RenderScene scene = slab(medium, reflected);
  const double area = pixels_of(scene.sensors[0]).area;
  return in_errors(times(area, rendered(scene, method, samples).pixels), {expected}, largest_error,
                   accuracy);
}

/// Checks that both faces, sensors of one run, together receive all power.
Finding slab_energy(const ScatteringMedium& medium, std::uint64_t samples) {
  RenderScene scene = slab(medium, true);
  scene.sensors.push_back(slab(medium, false).sensors[0]);
  const Estimate found = rendered(scene, RenderMethod::light, samples).pixels;
  const double area = pixels_of(scene.sensors[0]).area;
  return in_errors(area * (found.value[0] + found.value[1]),
                   area * std::hypot(found.error[0], found.error[1]), 1, 0.05);
}

void add_furnaces(ExtremeRows& rows) {
  const ScatteringMedium peaked = fog(5, 0, 0.999), thin = fog(1, 0, 0);
  const auto add = [&](bool slow, const char* name, const RenderScene& scene, int samples) {
    rows.add_timed(slow, name, "L / n^2 = 1 at a face and within, in errors", furnace, scene,
                   samples);
  };
  const auto stepped = [&](AnyIndexField field, double step) {
    RenderScene scene = in_box(std::move(field), peaked);
    scene.step = step;
    return scene;
  };
  const auto with_ball = [](RenderScene scene) {
    scene.stage.bodies.push_back({Sphere{Vec3(0.1, 0, 0.1), 0.6}, scene.stage.medium});
    return scene;
  };
  RenderScene sound = stepped(StandingWave(0.3, 0.05, 0, 40, 80), 0.01);
  sound.random_phase = true;
  const Luneburg lens(LuneburgProfile{.radius = 0.6}, Vec3(0.1, 0, 0.1));
  const FieldGrid grid{Vec3::Constant(-0.8), Vec3::Constant(0.4), {5, 5, 5}};
  std::vector<double> density(grid.size(), 1e-3);
  density[62] = 1e3;
  const ScatteringMedium spike{
      0.1, 0, {RayleighPhase{}}, std::make_shared<DensityGrid>(grid, density)};
  LabelVolume voxels{grid.origin, grid.spacing, {4, 4, 4}, std::vector<std::uint16_t>(64, 1)};
  voxels.labels[21] = 2;
  add(false, "white furnace, g 0.999", in_box(Homogeneous{0.3}, peaked), 4000);
  add(true, "white furnace, OD 200", in_box(Homogeneous{0.3}, fog(100, 0, 0)), 2000);
  add(true, "white furnace, fisheye, n from 4 to 0.12",
      stepped(Fisheye({.centre_excess = 3, .radius = 0.3}), 0.02), 1000);
  add(true, "white furnace, ramp of width 0.02, critical angle",
      stepped(TanhRamp{0.5, 0.1, 0.02}, 0.005), 1000);
  add(false, "white furnace, guide of n - 1 = 1e-6", in_box(ParabolicGuide({1e-6, 1e-3}), peaked),
      2000);
  add(true, "white furnace, sound of kr 40, all phases", sound, 2000);
  add(false, "white furnace, Luneburg lens and its rim", with_ball(in_box(lens, peaked)), 2000);
  add(false, "white furnace, ball of index 3, light trapped",
      with_ball(in_box(Homogeneous{2}, thin)), 4000);
  add(false, "white furnace, density of contrast 1e6", in_box(Homogeneous{0.3}, spike), 2000);
  add(false, "white furnace, one voxel of 1e6 times the extinction of others",
      in_box(Homogeneous{0.3}, labelled_medium(voxels, {1e-4, 0, 0, 1e-4, 0, 0, 100, 0, 0.9}, "")),
      2000);
  rows.add_timed(false, "picture of an empty stage under an environment", "each pixel is 1",
                 even_picture, in_box(Homogeneous{}, {}), 30'000);
  rows.add_timed(false, "picture of a scattering ball under an environment", "each pixel is 1",
                 even_picture, with_ball(in_box(Homogeneous{}, {.mu_s = 3})), 30'000);
}

/// Returns the reflectance of a deep slab without absorption by Milne's theory. The transmittance
/// is H(1) / sqrt 3 divided by the depth plus two extrapolation lengths.
double milne(double depth) {
  return 1 - 2.9078 / std::numbers::sqrt3 / (depth + 2 * 0.7104);
}

void add_slabs(ExtremeRows& rows) {
  const std::string peierls = "Peierls' equation, in errors",
                    energy = "reflected + transmitted = 1, in errors";
  static constexpr Chosen light = RenderMethod::light;
  // free flights are not forced to collide, so thinner slabs need more of them
  rows.add("slab of OD 0.01, reflected", peierls, [] {
    return share_row({0.01, 0}, true, light, 100'000, isotropic_slab(0.01, 1).reflected, 0.05);
  });
  rows.add("slab of OD 2, g 0.999", energy, slab_energy, fog(2, 0, 0.999), 20'000);
  rows.add("slab of OD 2, two terms of g 0.999 and -0.999", energy, slab_energy,
           ScatteringMedium{2, 0, {TwoTermPhase{{0.999}, {-0.999}, 0.9}}}, 20'000);
  rows.add("slab of OD 100", energy, slab_energy, ScatteringMedium{100, 0}, 2000);
  rows.add_slow("slab of OD 1000, reflected", "Milne, in errors", share_row,
                ScatteringMedium{1000, 0}, true, light, 10'000, milne(1000), 0.01, 0);
  rows.add_slow("half-space of albedo 1 - 1e-4, reflected", "Chandrasekhar's H, in errors", [] {
    const double albedo = 0.9999;
    return share_row({1000 * albedo, 1000 * (1 - albedo)}, true, light, 10'000,
                     isotropic_half_space(albedo), 0.01);
  });
  rows.add("slab of OD 2, albedo 0.5", peierls, [] {
    const auto exact = isotropic_slab(2, 0.5);
    const auto row = [](bool reflected, double expected) {
      return share_row({1, 1}, reflected, RenderMethod::bidirectional, 20'000, expected, 0.05);
    };
    return worse(row(true, exact.reflected), row(false, exact.transmitted));
  });
  rows.add("slab of OD 30 that absorbs all: 1e-13 transmitted", "exp(-30), in errors", share_row,
           ScatteringMedium{0, 30}, false, light, 1000, std::exp(-30.0), 1e-9, 1e-12);
}

/// Checks the derivative of the power on the far face with respect to one parameter of the medium.
Finding derivative(const ScatteringMedium& medium, int parameter, std::uint64_t samples,
                   double expected, double largest_error, double accuracy = 0) {
  RenderScene scene = slab(medium, false);
  scene.bins.derivatives = static_cast<int>(parameters_of(medium).size());
  const RenderJob job = render_job(scene, {RenderMethod::forward}, 1);
  const PowerGradients found =
      power_gradients(scene.sensors[0], 0, scene.bins, run_state(job, samples).sums);
  const Estimate own = part(found.mean, static_cast<std::size_t>(parameter), 1);
  return in_errors(times(pixels_of(scene.sensors[0]).area, own), {expected}, largest_error,
                   accuracy);
}

double through(double mu_s, double mu_a) {
  return isotropic_slab(mu_s + mu_a, mu_s / (mu_s + mu_a)).transmitted;
}

void add_gradients(ExtremeRows& rows) {
  const std::string peierls = "Peierls' equation, in errors";
  rows.add("derivative by mu_a, slab of OD 30 that absorbs all", "-exp(-30), in errors", derivative,
           ScatteringMedium{0, 30}, 0, 1000, -std::exp(-30.0), 1e-9, 1e-12);
  rows.add("derivative by mu_a of 1e-9, slab of OD 2", peierls, [] {
    const double exact = (through(2, 2e-3) - 4 * through(2, 1e-3) + 3 * through(2, 0)) / -2e-3;
    return derivative({2, 1e-9}, 1, 100'000, exact, 0.05);
  });
  rows.add_slow("derivative by mu_s, slab of OD 10", peierls, [] {
    const double exact = (through(10.01, 0.1) - through(9.99, 0.1)) / 0.02;
    return derivative({10, 0.1}, 0, 400'000, exact, 0.2);
  });
}

/// Checks the power on a disk at a distance in tissue.
Finding far_disk(double distance, std::uint64_t samples) {
  const RenderScene scene = tissue_disk(distance);
  const RenderJob job = render_job(scene, {RenderMethod::forward}, 1);
  const SensorResult found = render_result(scene, job, run_state(job, samples).sums)[0];
  return in_errors(*found.total, {power_on_tissue_disk(distance)}, 0.1, 1e-3);
}

/// Compares the fluence rate of a map without sensors.
Finding map_row(RenderScene scene, const std::vector<double>& expected, std::uint64_t samples) {
  scene.sensors.clear();
  const RenderJob job = render_job(scene, {}, 1);
  const Estimate found = fluence(run_state(job, samples).sums, job.first_of_map(), *scene.map);
  return in_errors(found, {expected.begin(), expected.end()}, 0.1);
}

/// Estimates the derivative of the power on the only disk with respect to the only parameter of the
/// field.
Estimate field_derivative(const RenderScene& scene, std::uint64_t samples) {
  const RenderJob job = render_job(scene, {RenderMethod::forward}, 1);
  return power_gradients(scene.sensors[0], 0, scene.bins, run_state(job, samples).sums).within;
}

void add_field_gradients(ExtremeRows& rows) {
  const auto by_alpha = [](const GuidedBeam& beam, double mu_s, double g, std::uint64_t samples) {
    RenderValues values = guided_values(beam, {0.3}, mu_s, g);
    values.gradient_by = {"alpha"};
    return field_derivative(make_render_scene(values), samples);
  };
  rows.add("derivative by alpha, 20 periods of a guide", "where rays go, relative", [=] {
    const GuidedBeam beam{0.2, 942};
    const double exact = beam.by_alpha(0.3);
    return Finding{std::abs(by_alpha(beam, 0, 0, 64).value[0].real() / exact - 1), 1e-3};
  });
  rows.add_slow("derivative by alpha, fog of g = 1 - 1e-9", "that without fog, in errors", [=] {
    const GuidedBeam beam{0.2, 6};
    const Estimate found = by_alpha(beam, 2, 1 - 1e-9, 40'000);
    return in_errors(found.value[0], found.error[0], beam.by_alpha(0.3), 0.1);
  });
  rows.add("derivative by an amplitude of 1e-8", "that of a thin lens, relative", [] {
    constexpr double k = 2, length = 30, radius = 0.1, beam = 0.25;
    RenderValues values;
    values.field.field = {UltrasoundValues::word};
    values.field.of<UltrasoundValues>().index = 1.33;
    values.field.of<UltrasoundValues>().amplitude = 1e-8;
    values.field.of<UltrasoundValues>().sound_wavenumber = k;
    values.stage.stage_box = {-5, -5, 0, 5, 5, length};
    values.lights.beam_light = {0, 0, 0, 0, 0, 1, beam, 1};
    values.sensors.sensor = {RadialValues::word};
    values.sensors.of<RadialValues>().sensor_at = {0, 0, length};
    values.sensors.of<RadialValues>().radii = {radius};
    values.gradient_by = {"amplitude"};
    // light is displaced by A k L^2 J_1(k rho) / (2 n) towards the axis
    const double inwards = k * length * length * std::cyl_bessel_j(1, k * radius) / (2 * 1.33);
    const double exact = 2 * radius * inwards / (beam * beam);
    const Estimate found = field_derivative(make_render_scene(values), 64);
    return Finding{std::abs(found.value[0].real() / exact - 1), 1e-4};
  });
}

void add_far_disks(ExtremeRows& rows) {
  rows.add_slow("disk at 60 mm in tissue: 8e-11 of the light", "harmonics (reflectance), in errors",
                far_disk, 60, 4000);
}

void add_maps(ExtremeRows& rows) {
  for (const double albedo : {0.1, 0.95})
    rows.add_slow("fluence 1 to 5 mean free paths off a lamp, albedo " + short_number(albedo),
                  "transport theory, in errors", [=] {
                    return map_row(oracles::lamp_map(albedo), oracles::lamp_fluence(albedo),
                                   albedo < 0.5 ? 3'000'000 : 200'000);
                  });
  rows.add("fluence in and around a ball of index 3", "4 pi n^2 in the white furnace, in errors",
           [] {
             RenderScene scene = in_box(Homogeneous{2}, fog(1, 0, 0));
             scene.stage.bodies.push_back({Sphere{Vec3::Zero(), 0.9}, fog(1, 0, 0)});
             scene.map = BoxCells({Vec3::Constant(-0.5), Vec3::Constant(0.5)}, {1, 1, 1});
             return map_row(scene, {36 * pi}, 100'000);
           });
  rows.add("fluence in a bubble in a ball of index 3", "4 pi n^2 in the white furnace, in errors",
           [] {
             RenderScene scene = in_box(Homogeneous{2}, fog(1, 0, 0));
             scene.stage.bodies.push_back({Sphere{Vec3::Zero(), 0.9}, fog(1, 0, 0)});
             scene.stage.bodies.push_back({Sphere{Vec3::Zero(), 0.6}, fog(1, 0, 0), 0});
             scene.map = BoxCells({Vec3::Constant(-0.3), Vec3::Constant(0.3)}, {1, 1, 1});
             return map_row(scene, {4 * pi}, 100'000);
           });
}

/// Returns the transmittance of a deep isotropic slab of albedo 0.9. Deep inside, light decays as
/// exp(-kappa depth).
double transmitted_deep(double optical_depth) {
  constexpr double albedo = 0.9, known = 20;
  double kappa = 0.5;  // albedo atanh(kappa) = kappa
  for (int i = 0; i < 200; ++i) kappa = std::tanh(kappa / albedo);
  return isotropic_slab(known, albedo).transmitted * std::exp(-kappa * (optical_depth - known));
}

void add_deep_slabs(ExtremeRows& rows) {
  const auto deep = [](double depth, Chosen method, int samples) {
    return share_row({0.9 * depth, 0.1 * depth}, false, method, samples, transmitted_deep(depth),
                     0.05, 1e-4);
  };
  const std::string decay = "transport's decay with depth, in errors";
  const Chosen light = RenderMethod::light;
  rows.add("slab of OD 50, albedo 0.9: 4e-12 transmitted", decay, deep, 50, light, 20'000);
  rows.add("slab of OD 200, albedo 0.9: 3e-46 transmitted", decay, deep, 200, light, 20'000);
}

/// Adds scenes in which the pilot run finds no light or only a single path, or cannot sample enough
/// paths to estimate the variance of the methods. The chosen method must be unbiased in all of
/// them.
void add_choices(ExtremeRows& rows) {
  static constexpr Chosen chosen;
  rows.add("chosen method, a beam that misses the sensor, clear", "no light", [] {
    RenderScene scene = slab({}, false);
    scene.lights = {BeamLight{{0, 0, 0.5}, Vec3::UnitX(), 0.01}};
    const Rendering dark = rendered(scene, chosen, 1000);
    return Finding{std::abs(dark.pixels.value[0]) + dark.pixels.error[0], 0};
  });
  rows.add("chosen method, clear slab", "all transmitted, in errors", share_row, ScatteringMedium{},
           false, chosen, 1000, 1, 1e-9, 1e-12);
  rows.add("chosen method, slab of OD 30 that absorbs all", "exp(-30), in errors", share_row,
           ScatteringMedium{0, 30}, false, chosen, 1000, std::exp(-30.0), 1e-9, 1e-12);
  rows.add("chosen method, slab of OD 0.01, reflected", "Peierls' equation, in errors", [] {
    return share_row({0.01, 0}, true, chosen, 100'000, isotropic_slab(0.01, 1).reflected, 0.1);
  });
  rows.add_slow(
      "chosen method, slab of OD 200, albedo 0.9: 3e-46 transmitted",
      "transport's decay with depth, in errors", [] {
        return share_row({180, 20}, false, chosen, 10'000, transmitted_deep(200), 0.05, 1e-4);
      });
  rows.add_slow("chosen method, slab of OD 1000, reflected", "Milne, in errors", share_row,
                ScatteringMedium{1000, 0}, true, chosen, 10'000, milne(1000), 0.01, 0);
  for (const double size : {1e-3, 1e-9})
    rows.add("chosen method, fog and a sensor of " + short_number(size), "irradiance pi, in errors",
             [=] {
               RenderScene scene = in_box(Homogeneous{}, fog(2, 0, 0.5));
               scene.sensors = {AreaDetector{{0, 0, 1}, Vec3::UnitY(), size, size, {}, pi / 2}};
               const Rendering face = rendered(scene, chosen, 4000);
               return in_errors(face.pixels.value[0], std::max(face.pixels.error[0], 1e-12), pi,
                                0.1);
             });
}

}  // namespace

void render_extremes(ExtremeRows& rows) {
  add_furnaces(rows);
  add_slabs(rows);
  add_gradients(rows);
  add_field_gradients(rows);
  add_far_disks(rows);
  add_maps(rows);
  add_deep_slabs(rows);
  add_choices(rows);
}

}  // namespace flatspeckle::bench
