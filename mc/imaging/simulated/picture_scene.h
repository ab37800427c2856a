#pragma once

#include <cstddef>
#include <vector>

#include "flatland/scene/scene.h"
#include "mc/imaging/recovery/phase_retrieval.h"

namespace flatspeckle::mc {

/// Incoherent points of an object in space. An object at infinity is in front of the box, and x and
/// y are the sines of the directions in which its points are seen.
struct PictureObject {
  std::vector<Vec> place;
  std::vector<double> brightness;
  bool far = false;
};

/// Point on a camera, in pixels.
struct PixelPlace {
  double x = 0, y = 0;
};

/// An object in space, a box, and the camera of far views behind the box.
struct PictureScene {
  /// Scene whose lights are the points and whose views are the pixels. It has no entries.
  Scene scene;
  PictureObject object;

  const FarCamera& camera() const { return *scene.request.camera; }
  /// Returns the expected number of speckle grains on the camera.
  double grains() const;
};

/// Makes a PictureScene. Throws InputError for points inside the box, or too far from it,
/// and for points at a finite distance from a box whose faces reflect.
PictureScene picture_scene(Scene medium, PictureObject object, const FarCamera& camera);

/// Returns the difference of direction cosines between neighbouring pixels.
double pixel_step(const FarCamera& camera);

/// Returns the light of a point of the object.
Light light_of(const PictureObject& object, Vec place);
/// Returns the middle of an object: that of the smallest cuboid that contains its points.
Vec middle_of(const PictureObject& object);
/// Returns the larger of the extents of an object along x and y.
double extent_of(const PictureObject& object);

/// Returns the place of a point in the picture, relative to that of a point on the axis. The
/// picture is upright: by the memory effect the speckle of the point moves by as many pixels in the
/// opposite direction (line_camera.h).
PixelPlace place_in_picture(const PictureScene& scene, Vec place);
/// Returns the pixels by which a point near the middle of the object moves in the picture if the
/// point moves by 1.
double picture_scale(const PictureScene& scene);

/// Returns the true picture: a Gaussian of full width at half maximum `width` pixels for each
/// point, about the middle of the object. The sum is 1.
std::vector<double> true_picture(const PictureScene& scene, std::size_t side, double width);

}  // namespace flatspeckle::mc
