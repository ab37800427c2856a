#include "grin/design/forms/field_form.h"

#include <algorithm>
#include <cmath>

namespace flatspeckle::grin::design {

namespace {

/// Inserts a knot into each cell along one axis of an array of spline coefficients: n coefficients
/// become 2 n - 3.
std::vector<double> with_knots(const std::vector<double>& values, std::array<int, 3>& extent,
                               int axis) {
  std::size_t inner = 1, outer = 1;
  for (int a = 0; a < axis; ++a) outer *= extent[a];
  for (int a = axis + 1; a < 3; ++a) inner *= extent[a];
  const std::size_t n = extent[axis], m = 2 * n - 3;
  std::vector<double> fine(outer * m * inner);
  for (std::size_t o = 0; o < outer; ++o)
    for (std::size_t j = 0; j < m; ++j)
      for (std::size_t i = 0; i < inner; ++i) {
        const auto c = [&](std::size_t at) { return values[(o * n + at) * inner + i]; };
        const std::size_t at = j / 2;
        fine[(o * m + j) * inner + i] =
            j % 2 == 0 ? (c(at) + c(at + 1)) / 2 : (c(at) + 6 * c(at + 1) + c(at + 2)) / 8;
      }
  extent[axis] = static_cast<int>(m);
  return fine;
}

/// Four coefficients define a cubic on one cell. Returns the coefficients of the same cubic after
/// the cell is divided into `cells` equal cells. Each new coefficient is the blossom (polar form)
/// of the cubic at three successive knots.
std::vector<double> in_cells(std::span<const double> c, int cells) {
  const double value = (c[0] + 4 * c[1] + c[2]) / 6, derivative = (c[2] - c[0]) / 2;
  const double square = (c[0] - 2 * c[1] + c[2]) / 2;
  const double cube = (c[3] - c[0]) / 6 + (c[1] - c[2]) / 2;
  std::vector<double> fine;
  for (int j = 0; j < cells + 3; ++j) {
    const double h = 1.0 / cells, u = (j - 2) * h, v = (j - 1) * h, w = j * h;
    fine.push_back(value + derivative * v + square * (u * v + v * w + w * u) / 3 +
                   cube * u * v * w);
  }
  return fine;
}

/// Returns the upper bound of a guide's correction s. This bound keeps n^2 = n0^2 (1 - 2 delta p)
/// above 0, where the profile p is at most (1 + s)^2 / (4 s).
double most_correction(double delta) {
  const double c = 1 / delta - 1;
  return std::min(3.0, 0.99 * (c + std::sqrt(c * c - 1)));
}

Bounds evenly_bounded(const CoefficientShape& shape, double least, double most) {
  return {std::vector<double>(shape.size(), least), std::vector<double>(shape.size(), most)};
}

void hold_faces(const CoefficientShape& shape, Bounds& bounds) {
  const auto is_free = [&](int i, int axis) {
    return i >= BoxForm::held && i < shape.extent[axis] - BoxForm::held;
  };
  std::size_t at = 0;
  for (int i = 0; i < shape.extent[0]; ++i)
    for (int j = 0; j < shape.extent[1]; ++j)
      for (int k = 0; k < shape.extent[2]; ++k, ++at)
        if (!is_free(i, 0) || !is_free(j, 1) || !is_free(k, 2))
          bounds.least[at] = bounds.most[at] = 0;
}

}  // namespace

/// Moves neighbours that differ by too much towards each other, again and again, until all keep the
/// bound, then scales the values for what is left.
void Bounds::hold_differences(std::span<double> values) const {
  constexpr int most_sweeps = 200;
  constexpr double margin = 1e-3;
  const int nx = shape.extent[0], ny = shape.extent[1], nz = shape.extent[2];
  const std::size_t strides[3] = {static_cast<std::size_t>(ny) * nz, static_cast<std::size_t>(nz),
                                  1};
  const auto each_pair = [&](const auto& use) {
    for (int i = 0; i < nx; ++i)
      for (int j = 0; j < ny; ++j)
        for (int k = 0; k < nz; ++k) {
          const std::size_t at = i * strides[0] + j * strides[1] + k;
          if (i + 1 < nx) use(at, at + strides[0]);
          if (j + 1 < ny) use(at, at + strides[1]);
          if (k + 1 < nz) use(at, at + strides[2]);
        }
  };
  double worst = 0;
  for (int sweep = 0; sweep < most_sweeps; ++sweep) {
    worst = 0;
    each_pair([&](std::size_t a, std::size_t b) {
      const double excess = std::abs(values[b] - values[a]) - *most_difference;
      if (!(excess > 0)) return;
      worst = std::max(worst, excess);
      const double move = std::copysign(excess / 2, values[b] - values[a]);
      values[a] = std::clamp(values[a] + move, least[a], most[a]);
      values[b] = std::clamp(values[b] - move, least[b], most[b]);
    });
    if (worst <= margin * *most_difference) break;
  }
  double largest = 0;
  each_pair([&](std::size_t a, std::size_t b) {
    largest = std::max(largest, std::abs(values[b] - values[a]));
  });
  if (largest <= *most_difference) return;
  for (double& value : values) value *= *most_difference / largest;
}

Bounds bounds_of(const FieldForm& form, double least_index, double most_index) {
  if (const auto* guide = std::get_if<GuideForm>(&form))
    return guide->coefficients > 0
               ? evenly_bounded(guide->shape(), -3, most_correction(guide->core.delta))
               : evenly_bounded(guide->shape(), 1, 10);
  Bounds bounds = evenly_bounded(shape_of(form), least_index - 1, most_index - 1);
  bounds.shape = shape_of(form);
  if (std::holds_alternative<BoxForm>(form)) hold_faces(shape_of(form), bounds);
  return bounds;
}

bool is_within(const FieldForm& form, std::size_t coefficient) {
  const auto* ball = std::get_if<BallForm>(&form);
  if (!ball) return true;
  const FieldGrid grid = ball->grid();
  const auto along = static_cast<std::size_t>(ball->nodes) + 2;
  const auto number = [&](std::size_t stride) {
    return static_cast<double>(coefficient / stride % along) - 1;
  };
  const Vec3 knot(number(along * along), number(along), number(1));
  return (grid.origin + grid.spacing.cwiseProduct(knot) - ball->centre).norm() < ball->radius;
}

std::optional<Surface> hull_of(const FieldForm& form) {
  if (const auto* box = std::get_if<BoxForm>(&form))
    return Box{box->centre - Vec3::Constant(box->radius),
               box->centre + Vec3::Constant(box->radius)};
  if (const auto* ball = std::get_if<BallForm>(&form)) return Sphere{ball->centre, ball->radius};
  if (const auto* radial = std::get_if<RadialForm>(&form))
    return Sphere{radial->centre, radial->radius};
  return std::nullopt;
}

FinerField finer(const FieldForm& form, std::span<const double> coefficients) {
  if (const auto* radial = std::get_if<RadialForm>(&form))
    return {radial->finer(), in_cells(coefficients, radial->finest - 3)};
  std::array<int, 3> extent = shape_of(form).extent;
  std::vector<double> values(coefficients.begin(), coefficients.end());
  for (int axis = 0; axis < 3; ++axis)
    if (extent[axis] > 1) values = with_knots(values, extent, axis);
  return {std::visit([](const auto& f) -> FieldForm { return f.finer(); }, form), values};
}

}  // namespace flatspeckle::grin::design
