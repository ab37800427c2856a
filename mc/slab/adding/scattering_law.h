#pragma once

#include <cmath>
#include <functional>
#include <vector>

#include "core/numbers/complex.h"
#include "flatland/scene/scene.h"

namespace flatspeckle::mc {

/// What a scatterer of a medium does to pairs of directions, without chance: the amplitude A of C14
/// over sqrt(sigma_s), so that |A|^2 is the phase function p, and p by its Fourier moments,
///   p(theta) = (moments[0] + 2 sum_m moments[m] cos(m theta)) / (2 pi).
/// Of fields at two times, between which the scatterers diffuse, the later one is the second of a
/// pair: each turn by theta loses exp(-2 delay (1 - cos theta)) (brownian.h).
class ScatteringLaw {
 public:
  /// The medium scatters.
  explicit ScatteringLaw(const Scene& scene, double delay = 0);

  /// A(theta - a) conj(A(theta - b)) of two lights, or of two views.
  Complex pair(double a, double b, double theta) const {
    return decay(theta - b) *
           (a == b ? Complex(std::norm(amplitude(theta - a)))
                   : product_with_conjugate(amplitude(theta - a), amplitude(theta - b)));
  }
  double decay(double angle) const {
    return delay_ == 0 ? 1 : std::exp(-2 * delay_ * (1 - std::cos(angle)));
  }
  Complex amplitude(double angle) const;

  /// Of Henyey-Greenstein's function without delay: d log pair / d g.
  double pair_slope(double g, double a, double b, double theta) const;

  const std::vector<double>& moments() const { return moments_; }
  /// The angle within which p changes.
  double width() const { return width_; }
  /// Narrower than what a quadrant's polynomials see.
  bool is_peaked() const { return width_ < 0.4; }
  /// If it is not: nodes on a quadrant that see its lobes.
  int least_order() const { return least_order_; }

 private:
  void tabulate(const Scene& scene);

  std::function<double(double)> density_;  ///< of a bulk: p of an angle in [0, pi]
  std::vector<Complex> table_;             ///< of scatterers: A at equal steps over [0, pi]
  std::vector<double> moments_;
  double delay_, width_ = 0;
  int least_order_ = 0;
};

}  // namespace flatspeckle::mc
