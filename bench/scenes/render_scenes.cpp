#include "bench/scenes/render_scenes.h"

#include <limits>
#include <numbers>

#include "bench/scenes/meshes.h"

namespace flatspeckle::bench {

using namespace grin;

ScatteringMedium fog(double mu_s, double mu_a, double g) {
  return {mu_s, mu_a, {HgPhase{g}}};
}

RenderScene tissue_disk(double distance) {
  const double half = 20 + 2 * distance, top = -1e-3;
  RenderScene scene{};
  scene.step = 1;
  scene.max_length = 1e9;
  scene.stage = {
      .boundary = Box{{-half, -half, top}, {half, half, half}},
      .bodies = {{Box{{-half, -half, 0}, {half, half, half}}, fog(10, 0.02, 0.9), 0.37}}};
  scene.lights = {BeamLight{{0, 0, top}, Vec3::UnitZ(), 1e-3}};
  scene.sensors = {RadialDetector{{distance, 0, top}, 1.5, 1, std::numbers::pi / 2, {}}};
  return scene;
}

double power_on_tissue_disk(double distance) {
  if (distance == 20) return 1.47102e-5;
  return distance == 30 ? 5.51492e-7 : 8.35024e-11;
}

RenderScene waveguide() {
  constexpr double wave_number = 3.40548;  // 813 kHz at 1500 m/s, per mm
  RenderScene scene{};
  scene.field = StandingWave(0.33, 0.001, 0, wave_number, 15);
  scene.step = 0.2;
  scene.max_length = 1000;
  scene.stage.boundary = Box{{-15, -15, 0}, {15, 15, 30}};
  scene.stage.medium = fog(0.1, 0, 0.85);
  scene.lights = {BeamLight{{0, 0, 0}, {0, 0, 1}, 0.5}};
  scene.sensors = {AreaDetector{{0, 0, 30}, {0, 1, 0}, 6, 6, {24, 24}, 0.1}};
  return scene;
}

namespace {

AreaDetector detector(const Vec3& centre, double size) {
  return {centre, {0, 1, 0}, size, size, {8, 8}, std::numbers::pi / 2};
}

RenderScene luneburg_lamp() {
  RenderScene scene{};
  scene.field = Luneburg({});
  scene.step = 0.1;
  scene.max_length = 100;
  scene.stage.boundary = Sphere{};
  scene.stage.medium = fog(0.5, 0, 0.5);
  scene.lights = {FaceLight{{0, 0, -1}, 0.6}};
  scene.sensors = {detector({0, 0, 1}, 1)};
  return scene;
}

RenderScene waveguide_lamp() {
  RenderScene scene = waveguide();
  scene.lights = {FaceLight{{0, 0, 0}, 10}};
  scene.sensors = {detector({0, 0, 30}, 16)};
  return scene;
}

RenderScene slab_lamp() {
  RenderScene scene{};
  scene.field = Homogeneous{};
  scene.step = 0.1;
  scene.max_length = 1000;
  scene.stage.boundary = Box{{-20, -20, 0}, {20, 20, 10}};
  scene.stage.medium = fog(0.5, 0.01, 0.8);
  scene.lights = {FaceLight{{0, 0, 0}, 5}};
  scene.sensors = {detector({0, 0, 10}, 20)};
  return scene;
}

RenderScene glass_ball_lamp() {
  RenderScene scene{};
  scene.field = Homogeneous{0.5};
  scene.step = 0.1;
  scene.max_length = 1000;
  scene.stage.boundary = Box{{-10, -10, -10}, {10, 10, 10}};
  scene.stage.medium = fog(0.05, 0, 0.5);
  scene.stage.bodies.push_back({Sphere{{0, 0, -2}, 4}});
  scene.lights = {FaceLight{{0, 0, -10}, 6}};
  scene.sensors = {detector({0, 0, 10}, 10)};
  return scene;
}

}  // namespace

std::vector<NamedRender> lamp_scenes() {
  return {{"luneburg", luneburg_lamp()},
          {"waveguide", waveguide_lamp()},
          {"slab", slab_lamp()},
          {"glass_ball", glass_ball_lamp()}};
}

RenderScene even_luneburg() {
  RenderScene scene = luneburg_lamp();
  scene.lights = {FaceLight{{0, 0, 0}, std::numeric_limits<double>::infinity()}};
  return scene;
}

RenderScene even_balls() {
  RenderScene scene = glass_ball_lamp();
  scene.stage.bodies.push_back({Sphere{{1, 0, -2}, 2}, fog(0.5, 0, 0), 0.3});
  scene.stage.bodies.push_back({Sphere{{-2, 1, 6}, 2}, fog(0.5, 0, 0), 0.4});
  scene.lights = even_luneburg().lights;
  return scene;
}

RenderScene even_ring() {
  RenderScene scene = even_luneburg();
  scene.field = Homogeneous{0.4};
  scene.stage = {.boundary = Box{{-1, -1, -1}, {1, 1, 1}},
                 .medium = {},
                 .bodies = {{smooth(torus_mesh(), 0.05), {.mu_s = 2}}}};
  return scene;
}

RenderScene beam_on_glass_ball() {
  RenderScene scene = glass_ball_lamp();
  scene.lights = {BeamLight{{0, 0, -10}, {0, 0, 1}, 2}};
  scene.sensors = {detector({10, 0, 0}, 10)};
  return scene;
}

}  // namespace flatspeckle::bench
