#pragma once

#include <cstddef>
#include <vector>

#include "core/numbers/complex.h"

namespace flatspeckle::wave {

/// Values of a function of x and z that is even in x, on a grid. Between its points the function is
/// interpolated by polynomials of degree 9 in each coordinate.
class EvenTable {
 public:
  /// Creates a table of zeros for |x| <= width, 0 <= z <= depth. The grid extends beyond these, so
  /// that its values are also needed for x and z somewhat larger. step_z is reduced to a fraction
  /// of the depth.
  EvenTable(double width, double depth, double step_x, double step_z);

  /// Returns the bytes that such a table needs.
  static double bytes(double width, double depth, double step_x, double step_z);

  std::size_t columns() const { return columns_; }
  std::size_t rows() const { return rows_; }
  /// Returns the coordinates of grid points. x of the first columns is negative.
  double x(std::size_t column) const;
  double z(std::size_t row) const { return step_z_ * static_cast<double>(row); }
  double step_x() const { return step_x_; }
  /// Returns the values of a row, followed by those of the rows after it.
  Complex* row(std::size_t row) { return &values_[row * columns_]; }

  /// Returns the interpolated value. Precondition: 0 <= x <= width, 0 <= z <= depth.
  Complex operator()(double x, double z) const;

 private:
  double step_x_, step_z_;
  std::size_t columns_, rows_;
  std::vector<Complex> values_;  // [z][x]
};

}  // namespace flatspeckle::wave
