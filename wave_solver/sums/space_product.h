#pragma once

#include <span>
#include <vector>

#include "core/numbers/complex.h"
#include "wave_solver/spheres/sphere_equations.h"
#include "wave_solver/sums/helmholtz_sum.h"

namespace flatspeckle::wave {

/// Product M x of SphereEquations for points, as a HelmholtzSum in space: pairs within `range()`
/// are summed directly, the others on a grid by FFT. The error is below `tolerance` times ||M x||.
class SpaceProduct {
 public:
  /// Precondition: equations.only_points().
  SpaceProduct(const SphereEquations& equations, double tolerance);

  /// Range of the HelmholtzSum; 0 if direct sums over all pairs are cheaper, or if the memory for
  /// the grid is not available. Then SphereEquations::apply() is quicker than this product.
  double range() const { return sum_.range(); }
  /// Returns M x, both [column][unknown]. Threaded unless called from a parallel region.
  std::vector<Complex> operator()(std::span<const Complex> x) const;

 private:
  HelmholtzSum sum_;
  std::vector<double> sigma_;
  std::vector<Complex> diagonal_;
};

}  // namespace flatspeckle::wave
