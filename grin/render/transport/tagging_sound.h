#pragma once

#include <cmath>
#include <complex>
#include <vector>

#include "grin/media/geometry/vec3.h"
#include "grin/render/stage/stage.h"

namespace flatspeckle::grin {

/// Sound that shifts the frequency of light (tagged light). At the sound's phase psi the phase of a
/// path is that without sound plus Re (m exp(-i psi)), with the modulation m of the path in rad.
/// Two mechanisms contribute to it: the sound changes the index along flights and moves the
/// scatterers (Wang [wang2001]; Sakadzic and Wang [sakadzic2002]). Both have the same origin, so
/// that they are correlated: conventions, C65.
struct TaggingSound {
  /// A plane wave: the index changes by Re amplitude exp(i (k.x - psi)), times the vacuum
  /// wavenumber of light.
  struct Wave {
    Vec3 k;
    std::complex<double> amplitude;
    double displacement;  ///< n / (strain_optic k^2), by which the gradient moves scatterers

    std::complex<double> at(const Vec3& x) const { return amplitude * std::polar(1.0, k.dot(x)); }
  };
  std::vector<Wave> waves;
  Part part = around;  ///< part of the stage in which there is sound

  /// Returns the modulation by the index along a straight segment.
  std::complex<double> flown(const Vec3& from, const Vec3& direction, double length) const {
    std::complex<double> sum = 0;
    for (const Wave& wave : waves) {
      const double half = wave.k.dot(direction) * length / 2;
      const double mean = std::abs(half) < 1e-6 ? 1 : std::sin(half) / half;
      sum += wave.at(from + length / 2 * direction) * (length * mean);
    }
    return sum;
  }
  /// Returns the modulation by the motion of a scatterer at x that turns light between two unit
  /// vectors.
  std::complex<double> turned(const Vec3& x, const Vec3& from, const Vec3& to) const {
    std::complex<double> sum = 0;
    for (const Wave& wave : waves)
      sum += std::complex(0.0, wave.displacement * wave.k.dot(from - to)) * wave.at(x);
    return sum;
  }
};

/// Sums of a pixel that sound requires: for each sideband, the light that is shifted by plus and
/// minus as many frequencies of the sound; then |m|^2 times the light.
inline constexpr int sidebands = 4, sideband_sums = sidebands + 1;

}  // namespace flatspeckle::grin
