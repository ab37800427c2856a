#include "wave_solver/layered/even_table.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace flatspeckle::wave {

namespace {

constexpr int stencil_points = 10, stencil_margin = stencil_points / 2;

/// Equally spaced nodes around a coordinate: the first of them, and interpolation weights of all.
struct Stencil {
  std::size_t first;
  std::array<double, stencil_points> weight;

  /// x: coordinate in steps from the first node of the grid.
  explicit Stencil(double x)
      : first(static_cast<std::size_t>(std::max(0, static_cast<int>(x) - stencil_margin + 1))) {
    static const auto inverse = inverse_denominators();
    const double t = x - static_cast<double>(first);
    std::array<double, stencil_points> below, above;  // products of distances to other nodes
    below[0] = above[stencil_points - 1] = 1;
    for (int i = 1; i < stencil_points; ++i) {
      below[i] = below[i - 1] * (t - (i - 1));
      above[stencil_points - 1 - i] = above[stencil_points - i] * (t - (stencil_points - i));
    }
    for (int i = 0; i < stencil_points; ++i) weight[i] = below[i] * above[i] * inverse[i];
  }

 private:
  static std::array<double, stencil_points> inverse_denominators() {
    std::array<double, stencil_points> inverse;
    for (int i = 0; i < stencil_points; ++i) {
      inverse[i] = 1;
      for (int j = 0; j < stencil_points; ++j)
        if (j != i) inverse[i] /= i - j;
    }
    return inverse;
  }
};

double steps_along(double extent, double step) {
  return std::ceil(extent / step);
}

}  // namespace

EvenTable::EvenTable(double width, double depth, double step_x, double step_z)
    : step_x_(step_x),
      step_z_(depth / steps_along(depth, step_z)),
      columns_(static_cast<std::size_t>(steps_along(width, step_x)) + 2 * stencil_margin + 1),
      rows_(static_cast<std::size_t>(steps_along(depth, step_z)) + stencil_margin + 1),
      values_(columns_ * rows_) {}

double EvenTable::bytes(double width, double depth, double step_x, double step_z) {
  return sizeof(Complex) * (steps_along(width, step_x) + 2 * stencil_points) *
         (steps_along(depth, step_z) + stencil_points);
}

double EvenTable::x(std::size_t column) const {
  return step_x_ * (static_cast<double>(column) - stencil_margin);
}

Complex EvenTable::operator()(double x, double z) const {
  const Stencil across(x / step_x_ + stencil_margin), deep(z / step_z_);
  std::array<double, 2 * stencil_points> sums{};
  for (int i = 0; i < stencil_points; ++i) {
    const auto* row =
        reinterpret_cast<const double*>(&values_[(deep.first + i) * columns_ + across.first]);
    for (int j = 0; j < 2 * stencil_points; ++j) sums[j] += deep.weight[i] * row[j];
  }
  Complex sum = 0;
  for (int j = 0; j < stencil_points; ++j)
    sum += across.weight[j] * Complex(sums[2 * j], sums[2 * j + 1]);
  return sum;
}

}  // namespace flatspeckle::wave
