#include <cmath>
#include <string>

#include <doctest/doctest.h>

#include "tests/mc/space/scenes_in_space.h"
#include "tests/space_boxes.h"

namespace flatspeckle::mc::test_space_boxes {

namespace {

/// Checks a Monte Carlo run against an independent one within 4 combined errors, and against exact
/// ensembles within 4 combined errors plus `allowance`, relative to the mean intensity.
void check_box(const std::string& name, std::uint64_t paths, double allowance) {
  const auto expected = flatspeckle::tests::read_space_box(name);
  const SceneSpec spec = flatspeckle::tests::space_box(name, true);
  Scene scene = mc::in_space(make_scene(spec), spec);
  scene.request = expected.request;
  const Estimate found = tests::run(scene, ReversedPaths::yes, paths, 5).entries();
  double square = 0;
  for (std::size_t e = 0; e < expected.exact.size(); ++e) {
    CAPTURE(e);
    const double error = std::abs(found.error[e]);
    CHECK(std::abs(found.value[e] - expected.paths[e]) <
          4 * std::hypot(error, expected.paths_error[e]));
    CHECK(error < 0.01 * expected.mean_intensity);
    const double off = std::abs(found.value[e] - expected.exact[e]);
    CHECK(off <
          2 * allowance * expected.mean_intensity + 4 * std::hypot(error, expected.exact_error[e]));
    square += off * off;
  }
  const double rms = std::sqrt(square / static_cast<double>(expected.exact.size()));
  MESSAGE(name, ": rms deviation from the exact ensemble ", rms / expected.mean_intensity);
  CHECK(rms < allowance * expected.mean_intensity);
}

}  // namespace

// The allowances are 1/(k l), and for points off resonance 2 k_shift / k more; views of the
// smallest intensity are allowed twice as much.
TEST_CASE("boxes in space: resonant points agree with exact ensembles and with other paths") {
  check_box("points_resonant", 100000, 1 / 28.4);
}

TEST_CASE("boxes in space: points off resonance agree with exact ensembles and other paths") {
  check_box("points_offresonance", 100000, 1 / 39.5 + 0.025);
}

TEST_CASE("boxes in space: penetrable spheres agree with exact ensembles and with other paths") {
  check_box("spheres_m2", 100000, 1 / 41.0);
}

}  // namespace flatspeckle::mc::test_space_boxes
