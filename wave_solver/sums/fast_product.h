#pragma once

#include <memory>
#include <span>
#include <vector>

#include "core/numbers/complex.h"
#include "wave_solver/equations/wave_equations.h"

namespace flatspeckle::wave {

class HelmholtzSum;
class RingProduct;

/// y = M x of WaveEquations in nearly linear time: point scatterers by a HelmholtzSum, others by
/// a RingProduct, and small systems, or such whose waves are too singular for a grid, block by
/// block. Shares no sum with WaveEquations::apply beyond near blocks, whose oracle that is. The
/// error is below `tolerance` of ||M x||, from 1e-12 on.
class FastProduct {
 public:
  /// Keeps a reference to the system.
  FastProduct(const WaveEquations& system, double tolerance);
  ~FastProduct();

  /// [column][unknown] to the same. Threaded unless called from a parallel region; the result does
  /// not depend on the number of threads.
  std::vector<Complex> operator()(std::span<const Complex> x) const;

 private:
  std::vector<Complex> sum_over_points(std::span<const Complex> x) const;

  const WaveEquations& system_;
  std::unique_ptr<const HelmholtzSum> points_;
  std::vector<double> sigma_;  // of points
  std::unique_ptr<const RingProduct> rings_;
};

}  // namespace flatspeckle::wave
