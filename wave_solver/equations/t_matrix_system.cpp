#include "wave_solver/equations/t_matrix_system.h"

#include <utility>

#include "wave_solver/equations/basis_order.h"

namespace flatspeckle::wave {

TMatrixSystem::TMatrixSystem(Placement placement, double k, double tolerance,
                             std::span<const Vec2> sensors)
    : WaveEquations(k), placement_(std::move(placement)) {
  const auto t = basis(placement_, k, tolerance, sensors);
  std::vector<Mode> modes;
  std::vector<Complex> diagonal;
  for (std::size_t j = 0; j < placement_.size(); ++j) {
    t_.emplace_back();
    modes.clear();
    diagonal.clear();
    for (int n = 0; n < static_cast<int>(t[j].size()); ++n) {
      const ScaledReal size = abs(t[j][n]), sigma = sqrt(size);
      t_[j].push_back(static_cast<ExtendedComplex>(t[j][n]));
      for (const bool odd : {false, true}) {
        if (n == 0 && odd) continue;
        modes.push_back({n, odd, n == 0 ? root_half * sigma : sigma});
        diagonal.push_back(size.value() > 0 ? -static_cast<Complex>(size / t[j][n]) : Complex(1));
      }
    }
    add({placement_[j].position, placement_[j].scatterer.disk_radius()}, modes, diagonal);
  }
}

std::vector<Complex> TMatrixSystem::source_side(Vec2 source) const {
  require_outside(placement_, source);
  auto side = outside_row(source);
  for (Complex& value : side) value *= Complex(0, -0.25);
  return side;
}

}  // namespace flatspeckle::wave
