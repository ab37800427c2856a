#include "bench/scenes/standard_scenes.h"

#include <cmath>
#include <numbers>

namespace flatspeckle::bench {

namespace {

constexpr double pi = std::numbers::pi;

/// 0 and 63 more, their sines equally spaced.
std::vector<double> tilts(double largest_sine) {
  std::vector<double> angles;
  for (int t = 0; t < 64; ++t) angles.push_back(std::asin(largest_sine * t / 63));
  return angles;
}

SceneSpec box(std::int64_t count, std::vector<double> views) {
  SceneSpec spec;
  spec.width = 20;
  spec.depth = 10;
  spec.count = count;
  spec.view_angles = std::move(views);
  spec.covariance = "memory_effect";
  spec.tilts = tilts(0.19);  // C_I = 1/2 near 0.12
  return spec;
}

SceneSpec cylinders(std::vector<double> views) {
  SceneSpec spec = box(67, std::move(views));
  spec.scatterer = "tm";
  spec.radius = 1 / (2 * pi);
  spec.index = "1.5";
  return spec;
}

SceneSpec slab(double g, double albedo = 1) {
  SceneSpec spec;
  spec.domain = "slab";
  spec.depth = 1000;
  spec.scatterer = "hg";
  spec.g = g;
  spec.albedo = albedo;
  spec.optical_depth = 10;
  spec.covariance = "memory_effect";
  spec.tilts = tilts(8 / (2 * pi * 1000));  // q depth = 8
  return spec;
}

}  // namespace

std::vector<StandardScene> standard_scenes() {
  const std::vector<double> across = {0.1, 0.8}, back = {pi, pi - 0.3};
  return {{"box_points, transmission", make_scene(box(31, across)), false},
          {"box_points, reflection", make_scene(box(31, back)), true},
          {"box_cylinders, transmission", make_scene(cylinders(across)), false},
          {"box_cylinders, reflection", make_scene(cylinders(back)), true},
          {"slab_hg, OD 10, g 0", make_scene(slab(0)), false},
          {"slab_hg, OD 10, g 0.9", make_scene(slab(0.9)), false}};
}

std::vector<StandardScene> absorbing_scenes() {
  SceneSpec points = box(39, {0.1, 0.8});
  points.albedo = 0.8;
  return {{"box_points_absorbing", make_scene(points), false},
          {"slab_hg, g 0, albedo 0.9", make_scene(slab(0, 0.9)), false},
          {"slab_hg, g 0.9, albedo 0.9", make_scene(slab(0.9, 0.9)), false}};
}

}  // namespace flatspeckle::bench
