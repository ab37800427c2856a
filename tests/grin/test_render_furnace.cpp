#include <doctest/doctest.h>

#include "tests/grin/furnace.h"

namespace flatspeckle::grin::tests {

// The white furnace (conventions, C24), shortly; test_render_furnace_full.cpp is for errors of
// 0.1 %.

TEST_CASE("light stays uniform without scattering, in every field and by every estimator") {
  for (const auto& [name, scene] : furnaces({})) {
    CAPTURE(name);
    for (const RenderMethod method : unbiased_methods) {
      CHECK(check_furnace_face(scene, method, 20000) < 0.03);
      // a body lenses light onto a pinhole, which light from far finds but seldom
      if (method != RenderMethod::light) {
        CHECK(check_furnace_camera(scene, method, 10000) < 0.01);
      }
    }
  }
}

TEST_CASE("light stays uniform where it scatters, in every field and by every estimator") {
  for (const auto& [name, scene] : furnaces(fog(1, 0, 0.85))) {
    CAPTURE(name);
    for (const RenderMethod method : unbiased_methods) {
      CHECK(check_furnace_face(scene, method, 20000) < 0.05);
      if (method != RenderMethod::light) {
        CHECK(check_furnace_camera(scene, method, 5000) < 0.05);
      }
    }
  }
}

}  // namespace flatspeckle::grin::tests
