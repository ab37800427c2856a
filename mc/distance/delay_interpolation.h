#pragma once

#include <span>
#include <vector>

#include <Eigen/Core>

#include "core/numbers/complex.h"

namespace flatspeckle::mc {

/// Interpolates small corrections of the light at detectors over its delays. Relative to the light,
/// a correction is a smooth function of the logarithm of the correlation, and thus a polynomial of
/// low degree.
class DelayInterpolation {
 public:
  /// light: uncorrected light [delay][detector]. The delays at which corrections are needed are
  /// those nearest to `points` Chebyshev points of the logarithm, at the detector where the
  /// correlation is least.
  DelayInterpolation(std::span<const Complex> light, std::size_t detectors, int points);

  /// Numbers of the delays at which corrections are needed, in ascending order.
  const std::vector<std::size_t>& chosen() const { return chosen_; }
  /// Returns corrections [part][delay][detector] from those at the chosen delays. They are not
  /// finite if the light at two of these is the same.
  std::vector<Complex> operator()(std::span<const Complex> at_chosen) const;

 private:
  std::size_t delays_, detectors_;
  std::vector<std::size_t> chosen_;
  /// Lagrange polynomials times the light at the delay over that at the chosen one, by detector:
  /// [delay][chosen].
  std::vector<Eigen::MatrixXd> weights_;
};

}  // namespace flatspeckle::mc
