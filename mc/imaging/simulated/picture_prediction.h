#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "core/numbers/statistics.h"
#include "mc/imaging/simulated/picture_frames.h"

namespace flatspeckle::mc {

/// Statistics of the speckle of points of an object, from light paths and without frames.
struct SpecklePrediction {
  /// Distances of two points, and C_I of their speckles, averaged over distances along x and along
  /// y about the middle of the object and over places on the camera.
  std::vector<double> separation;
  Estimate correlation;
  /// Autocorrelation of the intensity of speckle of unit variance at lags 0, 1, ... pixels along x
  /// and along y.
  std::vector<double> grain_x, grain_y;
  /// Autocorrelation of the fields, the squares of which are grain_x and grain_y.
  std::vector<double> field_x, field_y;
  /// Mean light of the object on each pixel, [y][x]; its mean over the pixels is 1.
  std::vector<double> light;
  /// Factor of the squared contrast due to motion during the exposure.
  double exposure = 1;

  /// Returns C_I at a distance, by linear interpolation; at larger distances the last value.
  double correlation_at(double distance) const;
  /// Returns the distance at which C_I is 1/2, if it lies within `separation`: the field of view.
  std::optional<double> field_of_view() const;
  /// Returns the full width at half maximum of the autocorrelation, in pixels.
  double grain() const;
};

/// Estimates the statistics by task.prediction_paths light paths. Distances reach 1.5 times the
/// extent of the object.
SpecklePrediction predicted_speckle(const PictureScene& scene, const PictureTask& task);

/// Expected quality of recovered pictures.
struct PicturePrediction {
  double similarity = 0, similarity_error = 0;  ///< mean structural similarity
  double success = 0;                           ///< probability of a success
};

/// Predicts the quality from task.draws sets of model frames, from which pictures are recovered as
/// from simulated ones. A model frame needs no media: it is the speckle of a thin layer, whose
/// fields have the autocorrelation of the medium's (field_x, field_y), convolved with a function
/// whose autocorrelation is the sum over all pairs of points of b b' C_I at their distance in the
/// picture, and multiplied by the mean light on each pixel; then the detector adds its noise. The
/// mean light matters because dividing a frame by its envelope leaves a part of it, which is as
/// high as the peaks of single pairs of many points. The model has no fitted constants. In it the
/// mean light of all points has the same form, and C_I depends on the transverse distance alone.
PicturePrediction predicted_pictures(const PictureScene& scene, const PictureTask& task,
                                     const SpecklePrediction& speckle,
                                     const std::vector<double>& truth);

}  // namespace flatspeckle::mc
