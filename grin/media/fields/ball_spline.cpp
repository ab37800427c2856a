#include "grin/media/fields/ball_spline.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "grin/media/index/field_file.h"

namespace flatspeckle::grin {

namespace {

Sphere ball_in(const FieldGrid& grid) {
  constexpr double rounding = 1e-9;
  const Vec3 size = grid.end() - grid.origin;
  const auto [least, most] = std::minmax({size[0], size[1], size[2]});
  if (!(most - least <= rounding * most))
    throw InputError("sides of the grid around a ball", listed(size), "must be equal");
  return {grid.origin + size / 2, least / 2};
}

/// Constructs a BallSpline from the grid of spline coefficients in a file. Along each axis, there
/// are two more coefficients than nodes.
struct BallGrid {
  BallGrid(const GridSamples& samples, double host)
      : ball(nodes_of(samples.where), samples.values, host - 1) {
    for (const double c : samples.values)
      if (!(c > -host && std::isfinite(c)))
        throw InputError("coefficient of a ball", c, "must be finite and above -host_index");
  }
  static FieldGrid nodes_of(FieldGrid where) {
    where.origin += where.spacing;
    for (int& nodes : where.nodes) nodes -= 2;
    return where;
  }
  BallSpline ball;
};

}  // namespace

BallSpline::BallSpline(const FieldGrid& grid, std::vector<double> coefficients, double host_excess)
    : spline_(SplineField::of_coefficients(grid, std::move(coefficients))),
      ball_(ball_in(grid)),
      inverse_area_(1 / (ball_.radius * ball_.radius)),
      host_excess_(host_excess) {}

FieldFacts facts(const BallSpline& field) {
  return {.scale = std::min(2 * field.spline().grid().spacing[0], field.ball().radius),
          .centre = field.ball().centre,
          .rim = field.ball(),
          .excess_beyond_rim = field.host_excess()};
}

void add_keys(Keys& keys, BallValues& values) {
  keys.add("ball_spline", values.ball, "Result of design, or HDF5 with its dataset ball_spline")
      .file();
}

BallSpline make_field(const Keys& keys, const BallValues& values, const FieldUse&) {
  const auto read = [](const std::string& path) {
    return BallGrid(read_samples(path, "ball_spline"), host_index_in(path, "ball_spline"));
  };
  return read_field(keys, keys.required(values.ball), read).ball;
}

}  // namespace flatspeckle::grin
