#pragma once

#include <optional>
#include <vector>

#include "flatland/scene/scene.h"
#include "mc/imaging/recovery/line_object.h"

namespace flatspeckle::mc {

/// A row of pixels: places along a line at this depth, or without one directions beyond the medium
/// (the side of larger z) whose sines are equally spaced.
struct LineCamera {
  std::optional<double> depth;
  double first = 0, last = 0;  ///< of x, or of the sines; first < last
  std::size_t pixels = 2;

  double step() const { return (last - first) / static_cast<double>(pixels - 1); }
  double place(double pixel) const { return first + step() * pixel; }
};

/// An object on a line outside the box, its camera, and the medium between or beside them.
struct LineScene {
  Scene scene;  ///< lights: the points, and the reference; views: the pixels; channels
                ///< [light][view], no entries
  LineObject object;
  double object_depth = 0;
  LineCamera camera;
  std::optional<double> reference = std::nullopt;  ///< x of a point that has a frame of its own
};

/// Throws InputError for what is inside the box, or nearer to it than scatterers reach.
LineScene line_scene(Scene medium, LineObject object, double object_depth, const LineCamera& camera,
                     std::optional<double> reference = std::nullopt);

/// Pixels that the speckle of a point near the axis moves by where the point moves by 1; the sign
/// is that of a picture. A source that moves by s at the distance d from the box tilts its light
/// there by -s/d, and light that leaves the box tilts alike (the memory effect): by -s/d in the
/// sine, by -s c/d on a line at the distance c.
double magnification(const LineScene& line);

/// Pixels by which the speckle of a point at x is shifted against that of a point on the axis: by
/// its sine, which is less than x / d.
double shift_of(const LineScene& line, double x);

/// The object in pixels by which its points' speckle is shifted against the reference's.
LineObject shifts(const LineScene& line);

/// Speckle grains that the camera can see: its range of sines times the box's width, in
/// wavelengths.
double most_grains(const LineScene& line);

/// The camera's view at a fraction of a pixel.
View view_at(const LineCamera& camera, double pixel);

}  // namespace flatspeckle::mc
