#include "wave_solver/sums/space_product.h"

#include <cmath>

#include "core/contract.h"

namespace flatspeckle::wave {

namespace {

std::vector<Vec> positions_of(const Placement& placement) {
  std::vector<Vec> positions;
  for (const auto& placed : placement) positions.push_back(placed.position);
  return positions;
}

}  // namespace

SpaceProduct::SpaceProduct(const SphereEquations& equations, double tolerance)
    : sum_(equations.k(), positions_of(equations.placement()), tolerance, Radial::spherical) {
  FS_EXPECT(equations.only_points());
  for (std::size_t j = 0; j < equations.unknowns(); ++j) {
    sigma_.push_back(std::sqrt(equations.strength(j)));
    diagonal_.push_back(equations.diagonal(j));
  }
}

std::vector<Complex> SpaceProduct::operator()(std::span<const Complex> x) const {
  const std::size_t size = sigma_.size();
  std::vector<Complex> charges(x.size());
  for (std::size_t i = 0; i < x.size(); ++i) charges[i] = sigma_[i % size] * x[i];
  auto y = sum_(charges);
  for (std::size_t i = 0; i < x.size(); ++i)
    y[i] = sigma_[i % size] * y[i] + diagonal_[i % size] * x[i];
  return y;
}

}  // namespace flatspeckle::wave
