#include "bench/scenes/standard_scenes.h"

#include <cmath>
#include <numbers>

namespace flatspeckle::bench {

Scatterer disk(Scatterer::Kind kind, double ka, Complex index) {
  return {.kind = kind, .radius = ka / (2 * std::numbers::pi), .index = index};
}

namespace {

/// A memory-effect scene with tilt 0 and 63 more, their sines equally spaced.
SceneSpec with_tilts(double largest_sine) {
  SceneSpec spec;
  spec.covariance = "memory_effect";
  for (int t = 0; t < 64; ++t) spec.tilts.push_back(std::asin(largest_sine * t / 63));
  return spec;
}

}  // namespace

Scene box_points() {
  SceneSpec spec = with_tilts(0.19);  // C_I = 1/2 near 0.12
  spec.width = 20;
  spec.depth = 10;
  spec.count = 31;
  spec.view_angles = {0.1, 0.8};
  return make_scene(spec);
}

Scene slab_hg(double g) {
  SceneSpec spec = with_tilts(8 / (2 * std::numbers::pi * 1000));  // q depth = 8
  spec.domain = "slab";
  spec.depth = 1000;
  spec.scatterer = "hg";
  spec.g = g;
  spec.optical_depth = 10;
  return make_scene(spec);
}

}  // namespace flatspeckle::bench
