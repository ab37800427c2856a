#pragma once

#include <optional>
#include <vector>

#include "grin/trace/trace_scene.h"

namespace flatspeckle::grin {

/// Modulation transfer function of an image along the two axes of RayImage.
struct Modulation {
  std::vector<double> frequency;  ///< cycles per length, from 0 to the cutoff 2 NA / wavelength
  std::vector<double> along_x, along_y;
  std::vector<double> of_ideal;  ///< the same without path differences
};

/// Quality of an image in coherent light from a point, for rays that fill the pupil evenly.
struct ImageQuality {
  double wavelength, aperture;  ///< aperture: numerical aperture of the image, index times sine
  /// Strehl ratio |mean of exp(2 pi i W / wavelength)|^2 of the path differences W about the centre
  /// of the spot, and about the point where their mean square is smallest.
  double strehl, best_strehl;
  /// Nullopt for fewer than 100 rays, for rays in a plane, and where path differences vary too
  /// fast.
  std::optional<Modulation> modulation;
};

/// Computes the quality of an image. The modulation is the autocorrelation of the pupil function.
/// Between the rays, path differences are interpolated by Zernike polynomials of up to eighth
/// order. Returns nullopt for parallel rays.
std::optional<ImageQuality> image_quality(const RayImage& image, const std::vector<TracedRay>& rays,
                                          double wavelength);

}  // namespace flatspeckle::grin
