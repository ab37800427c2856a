#include "apps/flatland/image_keys.h"

#include <limits>

#include "apps/command/command_line.h"
#include "core/error.h"

namespace flatspeckle::apps {

namespace {

void add_object_keys(Keys& keys, ImageKeys& values) {
  keys.group("Object and camera");
  keys.add("object_x", values.object_x, "x of the object's points, which are mutually incoherent")
      .unit("length");
  keys.add("object_brightness", values.object_brightness, "Brightness of each point (default: 1)")
      .positive();
  keys.add("object_count", values.object_count,
           "Number of object points used, in the order given (default: all)")
      .positive();
  keys.add("object_scale", values.object_scale, "Factor by which object_x is multiplied")
      .positive();
  keys.add(
          "object_depth", values.object_depth,
          "z of the object's points, outside the box; in space one value for each point, or one "
          "for "
          "all (default in space: at infinity, in front of the box; object_x and object_y are then "
          "sines of directions)")
      .unit("length");
  keys.add("camera_depth", values.camera_depth,
           "z of the line on which the camera's pixels lie, outside the box (default: at infinity, "
           "behind the box)")
      .unit("length");
  keys.add("camera", values.camera,
           "First and last pixel: x if camera_depth is given, otherwise the sine of the direction")
      .exactly(2, "first last");
  keys.add("pixels", values.pixels, "Number of pixels of the camera").from(64, 1 << 20);
  add_camera_keys(keys, values.noise);
  keys.add("background", values.noise.background,
           "Uniform background light, relative to the mean light over the pixels")
      .not_negative();
}

void add_reference_keys(Keys& keys, ImageKeys& values) {
  keys.group("Reference");
  keys.add("reference_x", values.reference_x,
           "x of a reference point on the object's line; frames are divided (deconvolved) by its "
           "frame")
      .unit("length");
  add_keys(keys, values.deconvolution);
}

void add_blinking_keys(Keys& keys, ImageKeys& values) {
  keys.group("Blinking");
  keys.add("blinking", values.blinking,
           "How the brightness of points varies between the frames of a medium: not at all (none), "
           "by random subsets, or by excitation with a different speckle pattern in each frame "
           "(speckle)")
      .one_of({"none", "subsets", "speckle"});
  keys.add("blinking_frames", values.blinking_frames, "Number of frames of each medium")
      .from(2, 100000);
  keys.add("lit", values.lit, "blinking = subsets: fraction of the frames in which a point shines")
      .between(0, 1);
  keys.add("excitation_wavelength", values.excitation_wavelength,
           "blinking = speckle: wavelength of the exciting light (default: wavelength)")
      .positive()
      .unit("length");
  keys.add("excitation_optical_depth", values.excitation_optical_depth,
           "blinking = speckle: optical depth of the medium at excitation_wavelength (default: "
           "optical_depth)")
      .positive();
  keys.add("excitation_paths", values.excitation_paths,
           "blinking = speckle: number of light paths for the covariance of the exciting field "
           "between the points")
      .positive();
  keys.add("sources", values.sources,
           "Number of sources into which frames are separated (default: determined from the "
           "singular values of the frames)")
      .from(1, 64);
}

/// Adds the keys of objects, cameras and recovery in space.
void add_space_keys(Keys& keys, ImageKeys& values) {
  flatspeckle::add_space_keys(keys, values.spec);
  for (const char* const name :
       {"light_azimuths", "view_azimuths", "tilt_azimuth", "beam_y", "pair_azimuths"})
    keys.remove(name);
  PictureKeys& space = values.space;
  keys.group("Object and camera in space", "dimension = 3");
  keys.add("object_y", space.object_y, "y of the object's points (default: 0)").unit("length");
  keys.add("object_picture", space.object_picture,
           "Picture (PNG, TIFF, NPY, PFM, HDF5, CSV) whose pixels above 0 are the object's points")
      .file();
  keys.add("object_width", space.object_width, "Width of object_picture, along x")
      .positive()
      .unit("length");
  keys.add("object_disc", space.object_disc, "Diameter of a disc of equal points, on the z axis")
      .positive()
      .unit("length");
  keys.add("object_spacing", space.object_spacing,
           "Distance between the points of object_disc (default: a speckle grain)")
      .positive()
      .unit("length");
  mc::add_keys(keys, space.detector);
  keys.add("exposure", space.moving.delays,
           "Time during which a frame adds up the light of a medium that moves, in the unit of the "
           "motion; requires an object at infinity")
      .exactly(1, "time");
  keys.add("exposure_steps", space.exposure_steps,
           "Number of times within the exposure at which fields are computed")
      .from(2, 1000)
      .only_of("exposure");
  add_length_unit_key(keys, space.length_unit);
  keys.group("Motion");
  mc::add_motion_keys(keys, space.moving);
  keys.group("Recovery of pictures", "dimension = 3");
  mc::add_keys(keys, space.phases);
  keys.add("least_similarity", space.least_similarity,
           "Structural similarity of a recovered picture and the true one above which the recovery "
           "counts as a success")
      .between(0, 1);
  keys.add("prediction_draws", space.prediction_draws,
           "Number of random autocorrelations from which the success is predicted (0: none)")
      .from(0, 100000);
}

}  // namespace

void add_image_keys(Keys& keys, ImageKeys& values) {
  add_scatterer_keys(keys, values.spec);
  add_bulk_keys(keys, values.spec);
  add_medium_keys(keys, values.spec);
  add_profile_keys(keys, values.spec);
  add_structure_key(keys, values.spec);
  add_faces_keys(keys, values.spec);
  add_object_keys(keys, values);
  add_reference_keys(keys, values);
  add_blinking_keys(keys, values);
  add_space_keys(keys, values);
  keys.group("Pictures");
  keys.add("repeats", values.repeats,
           "Number of random media, with one frame each; points are searched in each frame (0: "
           "compute only the prediction)")
      .from(0, std::numeric_limits<double>::infinity());
  mc::add_average_key(keys, values.average);
  keys.add("method", values.method,
           "paths: fields by light paths; wave: fields of placements by the exact solver")
      .one_of({"paths", "wave"});
  keys.add("paths_per_field", values.paths_per_field,
           "Number of light paths of each medium (default: enough for an excess kurtosis of 0.01, "
           "and at least four per visible grain)")
      .positive();
  add_wave_keys(keys, values.estimation);
  keys.remove("wave_samples");
  keys.add("points", values.points,
           "Number of points to recover (default: number of object points; 0: no search)")
      .from(0, 64);
  keys.add("object_extent", values.object_extent,
           "Longest distance between points in the search (default: 1.25 times the extent of the "
           "object)")
      .positive()
      .unit("length");
  keys.add("resolution", values.resolution,
           "Smallest distance between points, and tolerance within which a point counts as "
           "recovered, in speckle grains")
      .positive();
  keys.add("memory_range", values.memory_range,
           "Distance between two points at which the intensity correlation C_I of their speckles "
           "is 1/2; determines the weights of pairs in the search (default: equal weights)")
      .positive()
      .unit("length");
  keys.add("prediction_paths", values.prediction_paths,
           "Number of light paths for the prediction of the correlations of points (default: "
           "20000; in "
           "space 300000)")
      .positive();
}

std::uint64_t prediction_paths(const Keys& keys, const ImageKeys& values) {
  const std::int64_t usual = values.spec.dimension == 3 ? 300000 : 20000;
  return static_cast<std::uint64_t>(keys.read(values.prediction_paths).value_or(usual));
}

std::vector<double> brightness_of(const Keys& keys, const ImageKeys& values, std::size_t points) {
  auto brightness = keys.read(values.object_brightness);
  if (brightness.empty()) brightness.assign(points, 1);
  if (brightness.size() != points)
    throw InputError("object_brightness: has " + std::to_string(brightness.size()) +
                     " values, must have one for each of the " + std::to_string(points) +
                     " points");
  return brightness;
}

std::size_t count_of(const Keys& keys, const ImageKeys& values, std::size_t points) {
  const auto& count = keys.read(values.object_count);
  if (!count) return points;
  if (static_cast<std::size_t>(*count) > points)
    throw InputError(
        "object_count", *count,
        "must be at most " + std::to_string(points) + ", the number of points of the object");
  return static_cast<std::size_t>(*count);
}

}  // namespace flatspeckle::apps
