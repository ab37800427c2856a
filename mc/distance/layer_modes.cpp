#include "mc/distance/layer_modes.h"

#include <algorithm>
#include <cmath>

#include "core/numbers/symmetric.h"

namespace flatspeckle::mc {

std::vector<AxialMode> axial_modes(const LayerLosses& layer, int order) {
  // Without absorption the longest mode would not decay; this much changes nothing.
  constexpr double least_absorption = 1e-11;
  std::vector<double> root(layer.loss.size());
  for (std::size_t l = 0; l < root.size(); ++l)
    root[l] = std::sqrt(std::max(layer.loss[l], least_absorption * layer.beam));
  std::vector<AxialMode> modes;
  for (int m = 0; m < order; ++m) {
    const Eigen::Index size = order - m + 1;
    Eigen::VectorXd coupling(size - 1);
    for (int l = m; l < order; ++l)
      coupling[l - m] = RadianceHarmonics::coupling(l, m) / (root[l] * root[l + 1]);

    const auto [values, vectors] = tridiagonal_eigen(Eigen::VectorXd::Zero(size), coupling);
    for (Eigen::Index j = size - 1; j >= size - size / 2; --j) {
      AxialMode mode{m, values[j], {}};
      for (Eigen::Index i = 0; i < size; ++i)
        mode.coefficients.push_back(vectors(i, j) / root[m + i]);
      modes.push_back(std::move(mode));
    }
  }
  return modes;
}

LayerModes::LayerModes(const HarmonicRotation& rotation, const RadianceHarmonics& harmonics,
                       const std::vector<AxialMode>& axial, Complex q)
    : frequency(q),
      decay(axial.size()),
      norm(axial.size()),
      even(harmonics.even().size(), axial.size()),
      odd(harmonics.odd().size(), axial.size()),
      flow(harmonics.odd().size(), axial.size()) {
  constexpr Complex i(0, 1);
  for (std::size_t j = 0; j < axial.size(); ++j) {
    const double length = axial[j].length;
    decay[j] = std::sqrt(q * q + 1 / (length * length));
    const auto rotated =
        rotation(axial[j].azimuth, axial[j].coefficients, decay[j] * length, -i * q * length);
    const double scale = 1 / std::sqrt(rotated.even.squaredNorm() + rotated.odd.squaredNorm());
    norm[j] = decay[j] * length * length * scale * scale;
    even.col(j) = scale * rotated.even;
    odd.col(j) = scale * rotated.odd;
    flow.col(j) = harmonics.flow(even.col(j));
  }
}

}  // namespace flatspeckle::mc
