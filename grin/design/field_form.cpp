#include "grin/design/field_form.h"

namespace flatspeckle::grin::design {

namespace {

/// Along the axis of an array of coefficients, n of them become 2 n - 3.
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

}  // namespace

/// Coefficients in many cells of the cubic that four make in one: its blossom at three knots each.
std::vector<double> in_cells(std::span<const double> c, int cells) {
  const double value = (c[0] + 4 * c[1] + c[2]) / 6, slope = (c[2] - c[0]) / 2;
  const double square = (c[0] - 2 * c[1] + c[2]) / 2;
  const double cube = (c[3] - c[0]) / 6 + (c[1] - c[2]) / 2;
  std::vector<double> fine;
  for (int j = 0; j < cells + 3; ++j) {
    const double h = 1.0 / cells, u = (j - 2) * h, v = (j - 1) * h, w = j * h;
    fine.push_back(value + slope * v + square * (u * v + v * w + w * u) / 3 + cube * u * v * w);
  }
  return fine;
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
