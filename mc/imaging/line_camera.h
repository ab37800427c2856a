#pragma once

#include <optional>
#include <vector>

#include "flatland/scene/scene.h"
#include "mc/imaging/recovery/line_object.h"

namespace flatspeckle::mc {

/// A row of pixels. If `depth` is set, the pixels are positions along a line at that depth.
/// Otherwise they are far-field directions on the side of larger z, with equally spaced sines.
struct LineCamera {
  std::optional<double> depth;
  double first = 0, last = 0;  ///< x, or sine, of the first and of the last pixel; first < last
  std::size_t pixels = 2;

  double step() const { return (last - first) / static_cast<double>(pixels - 1); }
  double place(double pixel) const { return first + step() * pixel; }
};

/// An object on a line outside the box, its camera, and the medium between them or beside them.
struct LineScene {
  /// Scene whose lights are the points, then the reference, and whose views are the pixels. It has
  /// channels [light][view] and no entries.
  Scene scene;
  LineObject object;
  double object_depth = 0;
  LineCamera camera;
  /// Position x of a reference point, which has a separate frame.
  std::optional<double> reference = std::nullopt;
};

/// Makes a LineScene. Throws InputError for positions inside the box, or not farther from it than
/// the radius of a scatterer.
LineScene line_scene(Scene medium, LineObject object, double object_depth, const LineCamera& camera,
                     std::optional<double> reference = std::nullopt);

/// Returns the number of pixels by which the speckle of a point near the axis moves if the point
/// moves by a length of 1. As for an optical image, the number is negative if the picture is
/// inverted. If a source at the distance d from the box moves by s, the light incident on the box
/// tilts by -s/d. By the memory effect, the light that leaves the box tilts by the same angle. The
/// speckle moves by -s/d in the sine of the direction, or by -s c/d on a line at the distance c.
double magnification(const LineScene& line);

/// Returns the number of pixels by which the speckle of a point at x is shifted relative to that of
/// a point on the axis. The shift is proportional to the sine of the angle from the axis, which is
/// less than x / d for a point at the distance d from the box.
double shift_of(const LineScene& line, double x);

/// Returns the object in units of pixels: the positions are the shifts of the points' speckle
/// relative to the speckle of the reference, or of a point on the axis if there is no reference.
LineObject shifts(const LineScene& line);

/// Returns the largest number of speckle grains on the camera: the camera's range of sines times
/// the width of the box in wavelengths.
double most_grains(const LineScene& line);

/// Returns the sensor or detection direction at a fractional pixel.
View view_at(const LineCamera& camera, double pixel);

}  // namespace flatspeckle::mc
