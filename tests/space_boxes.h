#pragma once

#include <array>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "core/keys/csv.h"
#include "flatland/scene/scene.h"

namespace flatspeckle::tests {

/// Covariances in a box in space (data/reference/README.md).
struct SpaceBoxReference {
  CovarianceRequest request{};
  std::vector<Complex> exact, paths;
  std::vector<double> exact_error, paths_error;
  double mean_intensity = 0;
};

struct SpaceAngles {
  double angle, azimuth;
};

/// Returns the angles of the direction with these cosines; side: sign of its z.
inline SpaceAngles space_angles(double x, double y, double side) {
  const double z = side * std::sqrt(1 - x * x - y * y);
  return {std::atan2(std::hypot(x, y), z), std::atan2(y, x)};
}

inline SpaceBoxReference read_space_box(const std::string& name) {
  const Table table = read_csv(FLATSPECKLE_DATA "/reference/space/box_" + name + ".csv");
  SpaceBoxReference found;
  std::vector<AnglePair> pairs;
  for (std::size_t row = 0; row < table.rows(); ++row) {
    const auto value = [&](const std::string& column) { return table.column(column)[row]; };
    const auto light = [&](const std::string& number) {
      return space_angles(value("light_" + number + "_x"), value("light_" + number + "_y"), 1);
    };
    const auto view = [&](const std::string& number) {
      return space_angles(value("view_" + number + "_x"), value("view_" + number + "_y"),
                          value("view_" + number + "_side"));
    };
    const SpaceAngles l1 = light("1"), v1 = view("1"), l2 = light("2"), v2 = view("2");
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

/// Returns the box of a reference (its README). fixed: whether the number of scatterers is the same
/// in all placements.
inline SceneSpec space_box(const std::string& name, bool fixed) {
  const bool resonant = name == "points_resonant", spheres = name == "spheres_m2";
  const std::array<double, 3> size = resonant  ? std::array{6.0, 6.0, 4.0}
                                     : spheres ? std::array{5.0, 5.0, 4.0}
                                               : std::array{6.0, 5.0, 4.0};
  const std::int64_t count = resonant ? 100 : spheres ? 50 : 120;
  SceneSpec spec;
  spec.dimension = 3;
  spec.width = size[0];
  spec.height = size[1];
  spec.depth = size[2];
  if (fixed)
    spec.count = count;
  else
    spec.density = static_cast<double>(count) / (size[0] * size[1] * size[2]);
  if (!resonant && !spheres) spec.phase_shift = std::numbers::pi / 4;
  if (!spheres) return spec;
  spec.scatterer = "penetrable";
  spec.radius = 1 / (2 * std::numbers::pi);
  spec.index = "2";
  return spec;
}

}  // namespace flatspeckle::tests
