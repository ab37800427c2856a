#pragma once

#include <optional>
#include <vector>

#include "core/numbers/complex.h"
#include "flatland/media/domain.h"
#include "wave_solver/equations/cylinder_waves.h"
#include "wave_solver/equations/wave_equations.h"

namespace flatspeckle::wave {

/// Plane waves that carry the field from the copies n > Copies::count of a region (those on its
/// right) to the region itself:
///   sum_n e^{i n phase} H_0(k |r - r' - n period x|)
///     = sum_ij a_i(r) coupling_ij b_j(r'),   a_i(r) = e^{i k w_i.(r - right)},
///                                            b_j(r') = e^{-i k w_j.(r' - left)}.
/// Waves b_j evaluated for outgoing modes (expand_plane_wave) give the same for higher orders. The
/// sum over n of the spectral integral of H_0 is a geometric series, whose integrand has poles at
/// the channels of the period (Yasumoto and Yoshitomi [yasumoto1999]). The path of integration
/// passes near the real directions as far as the region's depth requires, and is refined until the
/// error is below the tolerance. An interpolative decomposition then keeps the few of its plane
/// waves that are linearly independent in the region.
struct ImageWaves {
  /// Wave of a channel close to grazing, with w and phases as above. Its coupling is `coupling`
  /// divided by `grazing`, the z component of the channel's direction, which is 0 at a Wood
  /// anomaly. It is not part of the other waves.
  struct Grazing {
    WaveDirection w;
    Complex coupling, grazing;
  };

  std::vector<WaveDirection> w;
  std::vector<Complex> coupling;  ///< symmetric matrix
  Vec right, left;                ///< phase origins
  std::optional<Grazing> grazing;
};

/// region: contains all scatterers of the cell. Its depth must be at most the distance of the
/// nearest of these copies, image_distance(). tolerance: error of the sum.
ImageWaves image_waves(double k, const Copies& copies, const Rectangle& region, double tolerance);

/// Returns the distance along x between the region and the nearest copy beyond Copies::count.
inline double image_distance(const Copies& copies, const Rectangle& region) {
  return (copies.count + 1) * copies.period - region.width();
}

}  // namespace flatspeckle::wave
