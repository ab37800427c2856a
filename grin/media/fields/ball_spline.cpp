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
  BallGrid(const FieldGrid& where, std::span<const double> values)
      : ball(nodes_of(where), {values.begin(), values.end()}) {
    for (const double c : values)
      if (!(c > -1 && std::isfinite(c)))
        throw InputError("coefficient of a ball", c, "must be finite and above -1");
  }
  static FieldGrid nodes_of(FieldGrid where) {
    where.origin += where.spacing;
    for (int& nodes : where.nodes) nodes -= 2;
    return where;
  }
  BallSpline ball;
};

}  // namespace

BallSpline::BallSpline(const FieldGrid& grid, std::vector<double> coefficients)
    : spline_(SplineField::of_coefficients(grid, std::move(coefficients))),
      ball_(ball_in(grid)),
      inverse_area_(1 / (ball_.radius * ball_.radius)) {}

FieldFacts facts(const BallSpline& field) {
  return {.scale = std::min(2 * field.spline().grid().spacing[0], field.ball().radius),
          .centre = field.ball().centre,
          .rim = field.ball()};
}

void add_keys(Keys& keys, BallValues& values) {
  keys.add("ball_spline", values.ball, "Result of design, or HDF5 with its dataset ball_spline")
      .file();
}

BallSpline make_field(const Keys& keys, const BallValues& values, const FieldUse&) {
  const auto read = [](const std::string& path) {
    return read_grid<BallGrid>(path, "ball_spline");
  };
  return read_field(keys, keys.required(values.ball), read).ball;
}

}  // namespace flatspeckle::grin
