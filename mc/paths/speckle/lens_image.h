#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "core/numbers/complex.h"
#include "flatland/scene/scene.h"
#include "mc/paths/speckle/speckle_field.h"

namespace flatspeckle::mc {

/// Square in the plane z = focus, centred on the z axis, that a lens images on pixels.
struct LensPlane {
  double focus = 0;        ///< depth of the plane, inside, behind or in front of the medium
  double width = 0;        ///< side of the square
  std::size_t pixels = 0;  ///< number of pixels along each side

  /// Returns the x or y coordinate of the middle of a column or row.
  double coordinate(std::size_t i) const {
    return width * ((static_cast<double>(i) + 0.5) / static_cast<double>(pixels) - 0.5);
  }
};

/// Returns a camera with the axis and aperture of `lens`, whose pixels sample the pupil finely
/// enough for images of the box.
FarCamera pupil_of(const FarCamera& lens, const LensPlane& image, const Domain& box,
                   double wavelength);

/// Image of the far field A(v) through a lens with a round pupil around the axis of a camera
/// (conventions, C59):
///   u(x, y) = (i k / (2 pi)) int_pupil A(v) exp(i k (v_x x + v_y y + v_z focus)) dv_x dv_y /
///   |v_z|.
/// It equals the scattered field in the plane, without the waves that miss the pupil, as if this
/// field had reached the pupil without further scattering.
class LensImage {
 public:
  LensImage(const FarCamera& pupil, const LensPlane& image, double k);

  /// Computes the image [y][x] of a field on the pupil [v_y][v_x].
  void form(std::span<const Complex> far, std::span<Complex> out) const;

 private:
  std::size_t across_, pixels_;
  std::vector<Complex> weights_;  ///< of each pixel of the pupil
  std::vector<Complex> x_, y_;    ///< phases [pixel of the image][pixel of the pupil]
};

/// Draws the images of the fields that `draw` draws on the pupil. Intensities are |u|^2.
FieldDraw images_of(FieldDraw draw, const LensImage& lens, std::size_t fields,
                    std::size_t pupil_pixels);

}  // namespace flatspeckle::mc
