#pragma once

#include <span>

#include "grin/design/adjoint/designed_field.h"

namespace flatspeckle::grin::design {

/// The sum of the squares of the third differences of coefficients along each axis, with the
/// matrix D^T D of which that is the square form.
class Roughness {
 public:
  explicit Roughness(const CoefficientShape& shape) : shape_(shape) {}

  /// Adds weight D^T D values.
  void add_times(std::span<const double> values, double weight, std::span<double> sums) const;
  /// Adds weight times the diagonal of D^T D.
  void add_diagonal(double weight, std::span<double> sums) const;
  double square(std::span<const double> values) const;

 private:
  template <class Use>
  void each_difference(const Use& use) const;

  CoefficientShape shape_;
};

}  // namespace flatspeckle::grin::design
