#pragma once

#include <memory>
#include <utility>

#include "bench/scenes/random_fields.h"
#include "tests/grin/furnace.h"

// Scenes of render tests.
namespace flatspeckle::grin::tests {

/// Returns a Rayleigh medium with a density on a grid.
inline ScatteringMedium grid_medium() {
  const FieldGrid grid{Vec3::Constant(-0.8), Vec3::Constant(0.4), {5, 5, 5}};
  std::vector<double> density(grid.size());
  for (std::size_t i = 0; i < density.size(); ++i) density[i] = static_cast<double>(i * 7 % 11) / 5;
  return {2, 0.2, {RayleighPhase{}}, std::make_shared<DensityGrid>(grid, density)};
}

/// Returns the white-furnace scenes: several index fields in the box, illuminated by the
/// environment. The scattering medium in the box and in the ball is `medium`.
inline std::vector<NamedRender> furnaces(const ScatteringMedium& medium) {
  const Stage stage{unit_box(), medium};
  Stage with_ball = stage;
  with_ball.bodies.push_back({Sphere{Vec3(0.1, 0, 0.1), 0.6}, medium});
  RandomStream random(5, 93, 0);
  AnySum sum;
  sum.add(bench::random_blobs(random, 0.1))
      .add(bench::random_spline(random, 0.03))
      .add(Homogeneous{0.2});
  const auto in = [](AnyIndexField field, const Stage& where) {
    return scene_in(std::move(field), where, environment(), whole_face());
  };
  std::vector<NamedRender> all{
      {"homogeneous", in(Homogeneous{0.3}, stage)},
      {"Luneburg", in(Luneburg(LuneburgProfile{.radius = 0.6}, Vec3(0.1, 0, 0.1)), with_ball)},
      {"fisheye", in(Fisheye({.centre_excess = 1, .radius = 1.5}), stage)},
      {"guide", in(ParabolicGuide({.axis_excess = 0.5, .alpha = 0.6}), stage)},
      {"sound", in(StandingWave(0.3, 0.1, 0, 4.0, 3.0), stage)},
      {"blobs and spline", in(sum, stage)},
      {"glass ball", in(Homogeneous{0.5}, with_ball)},
      {"clear ball", in(Homogeneous{}, with_ball)}};
  all[4].scene.random_phase = true;
  return all;
}

/// Returns white-furnace scenes with several bodies.
inline std::vector<NamedRender> furnaces_of_bodies(const ScatteringMedium& medium) {
  Stage balls{unit_box(), medium};  // one inside another, one apart
  balls.bodies.push_back({Sphere{Vec3(0.1, 0, 0.1), 0.6}, medium});
  balls.bodies.push_back({Sphere{Vec3(0.2, 0, 0.2), 0.3}, medium, 0.1});
  balls.bodies.push_back({Sphere{Vec3(-0.6, -0.6, 0.5), 0.3}, medium, 0.8});
  Stage layers{unit_box(), medium};  // touching layers
  layers.bodies.push_back({Box{{-0.7, -0.8, -0.5}, {0.9, 0.8, 0.6}}, medium});
  layers.bodies.push_back({Box{{-0.7, -0.8, -0.5}, {0.9, 0.8, 0.3}}, medium, 0.2});
  layers.bodies.push_back({Box{{-0.7, -0.8, -0.5}, {0.9, 0.8, -0.1}}, medium, 0.6});
  Stage turned{unit_box(), medium};  // a cylinder through a turned box
  turned.bodies.push_back(
      {TurnedShape(Box{{-0.5, -0.6, -0.4}, {0.6, 0.5, 0.5}}, {0.3, 0.5, -0.2}), medium, 0.2});
  turned.bodies.push_back(
      {TurnedShape::cylinder({-0.7, -0.6, 0.1}, {0.6, 0.7, -0.2}, 0.2), medium, 0.6});
  Stage mirrors{unit_box(), medium};  // a mirror beside a ball of glass
  mirrors.bodies.push_back({Sphere{Vec3(-0.3, 0.1, 0.2), 0.5}, medium, 0.4});
  mirrors.bodies.push_back({TurnedShape(Box{{0.2, -0.7, -0.6}, {0.4, 0.6, 0.5}}, {0.1, 0.4, 0.2}),
                            {},
                            -1,
                            "body_",
                            BodyFace::reflects});
  const Luneburg luneburg(LuneburgProfile{.radius = 0.6}, Vec3(0.1, 0, 0.1));
  return {{"ball in a ball", scene_in(Homogeneous{0.5}, balls, environment(), whole_face())},
          {"ball in a Luneburg ball", scene_in(luneburg, balls, environment(), whole_face())},
          {"layers", scene_in(Homogeneous{0.4}, layers, environment(), whole_face())},
          {"turned bodies", scene_in(Homogeneous{}, turned, environment(), whole_face())},
          {"mirror", scene_in(Homogeneous{}, mirrors, environment(), whole_face())}};
}

}  // namespace flatspeckle::grin::tests
