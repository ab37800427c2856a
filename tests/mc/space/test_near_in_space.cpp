// Near sources, near sensors and beams in space, against an exact ensemble.
#include <array>
#include <cmath>

#include <doctest/doctest.h>

#include "core/keys/csv.h"
#include "tests/mc/space/scenes_in_space.h"

namespace flatspeckle::mc::test_near_in_space {

namespace {

Scene box_of_points(const Lights& lights, const std::vector<View>& views) {
  SceneSpec spec;
  spec.dimension = 3;
  spec.width = spec.height = 6;
  spec.depth = 4;
  spec.count = 100;
  Scene scene = mc::in_space(make_scene(spec), spec);
  scene.request = intensity_request(lights, views);
  return scene;
}

}  // namespace

TEST_CASE("near ends in space: intensities agree with an exact ensemble") {
  const Table expected = read_csv(FLATSPECKLE_DATA "/reference/space/near_points_resonant.csv");
  const Light plane = plane_wave(0.3);
  const std::vector<Light> lights{plane, point_source({0.5, -1.5, -0.4}),
                                  gaussian_beam(0.2, {0.3, 1, 0.2}, 1.5, 0.7)};
  const std::vector<View> views{far_view(0.7, 1), far_view(0.3 + tests::pi),
                                near_sensor({0.4, 5, 0.3}), near_sensor({-1, 2, 0.5}),
                                near_sensor({0.5, 2.5, 3.6})};
  // Every light has its own run, because one run for all would sample dim lights badly.
  for (std::size_t light = 0; light < lights.size(); ++light) {
    const Scene scene = box_of_points({lights[light]}, views);
    const Estimate found = tests::run(scene, ReversedPaths::yes, 100000, 3).entries();
    for (std::size_t row = 0; row < expected.rows(); ++row) {
      const auto column = [&](const char* name) { return expected.column(name)[row]; };
      if (column("light") != static_cast<double>(light)) continue;
      const auto view = static_cast<std::size_t>(column("view"));
      // A sensor inside the medium receives rare, large values (docs/space.md).
      const bool inside = view == 3;
      const double variance = column("variance"), error = found.error[view] / variance;
      CAPTURE(light);
      CAPTURE(view);
      CHECK(error < (inside ? 0.1 : 0.02));
      // Monte Carlo neglects terms of the order 1/(k l) = 1/28.4.
      CHECK(std::abs(found.value[view] / variance - 1.0) <
            1 / 28.4 + 4 * std::hypot(error, column("error") / variance));
    }
  }
}

}  // namespace flatspeckle::mc::test_near_in_space
