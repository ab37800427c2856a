#include <array>
#include <cmath>
#include <string>

#include <doctest/doctest.h>

#include "core/keys/csv.h"
#include "tests/mc/space/scenes_in_space.h"

namespace flatspeckle::mc::test_space_boxes {

namespace {

using tests::pi;

/// Covariances in a box in space (data/reference/README.md).
struct Reference {
  CovarianceRequest request;
  std::vector<Complex> exact, paths;
  std::vector<double> exact_error, paths_error;
  double mean_intensity = 0;
};

struct Angles {
  double angle, azimuth;
};

/// Returns the angles of the direction with these cosines; side: sign of its z.
Angles angles(double x, double y, double side) {
  const double z = side * std::sqrt(1 - x * x - y * y);
  return {std::atan2(std::hypot(x, y), z), std::atan2(y, x)};
}

Reference read_reference(const std::string& name) {
  const Table table = read_csv(FLATSPECKLE_DATA "/reference/space/box_" + name + ".csv");
  Reference found;
  std::vector<AnglePair> pairs;
  for (std::size_t row = 0; row < table.rows(); ++row) {
    const auto value = [&](const std::string& column) { return table.column(column)[row]; };
    const auto light = [&](const std::string& number) {
      return angles(value("light_" + number + "_x"), value("light_" + number + "_y"), 1);
    };
    const auto view = [&](const std::string& number) {
      return angles(value("view_" + number + "_x"), value("view_" + number + "_y"),
                    value("view_" + number + "_side"));
    };
    const Angles l1 = light("1"), v1 = view("1"), l2 = light("2"), v2 = view("2");
    pairs.push_back(
        {l1.angle, v1.angle, l2.angle, v2.angle, {l1.azimuth, v1.azimuth, l2.azimuth, v2.azimuth}});
    found.exact.emplace_back(value("exact_re"), value("exact_im"));
    found.paths.emplace_back(value("mc_re"), value("mc_im"));
    found.exact_error.push_back(value("exact_error"));
    found.paths_error.push_back(value("mc_error"));
    constexpr std::size_t intensities = 10;  // the first rows of each table
    if (row < intensities) found.mean_intensity += value("exact_re") / intensities;
  }
  found.request = pairs_request(pairs);
  return found;
}

Scene box(const std::array<double, 3>& size, double count, const std::string& scatterer) {
  SceneSpec spec;
  spec.dimension = 3;
  spec.width = size[0];
  spec.height = size[1];
  spec.depth = size[2];
  spec.count = static_cast<std::int64_t>(count);
  spec.scatterer = scatterer;
  if (scatterer == "point" && count == 120) spec.phase_shift = pi / 4;
  if (scatterer == "penetrable") {
    spec.radius = 1 / (2 * pi);
    spec.index = "2";
  }
  return mc::in_space(make_scene(spec), spec);
}

/// Checks a Monte Carlo run against an independent one within 4 combined errors, and against exact
/// ensembles within 4 combined errors plus `allowance`, relative to the mean intensity.
void check_box(Scene scene, const std::string& name, std::uint64_t paths, double allowance) {
  const Reference expected = read_reference(name);
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
  check_box(box({6, 6, 4}, 100, "point"), "points_resonant", 100000, 1 / 28.4);
}

TEST_CASE("boxes in space: points off resonance agree with exact ensembles and other paths") {
  check_box(box({6, 5, 4}, 120, "point"), "points_offresonance", 100000, 1 / 39.5 + 0.025);
}

TEST_CASE("boxes in space: penetrable spheres agree with exact ensembles and with other paths") {
  check_box(box({5, 5, 4}, 50, "penetrable"), "spheres_m2", 100000, 1 / 41.0);
}

}  // namespace flatspeckle::mc::test_space_boxes
