#pragma once

#include <cstdint>
#include <vector>

#include "core/frames/frames.h"
#include "mc/imaging/camera_exposure.h"
#include "mc/imaging/recovery/phase_retrieval.h"
#include "mc/imaging/retrieval/picture_datasets.h"
#include "mc/imaging/simulated/picture_scene.h"
#include "mc/imaging/simulated/picture_score.h"
#include "mc/paths/speckle/field_changes.h"
#include "mc/paths/speckle/speckle_field.h"

namespace flatspeckle::mc {

/// Settings of the simulation of frames in space and of the recovery of pictures from them.
struct PictureTask {
  std::uint64_t repeats = 1;  ///< number of pictures; 0: only the prediction
  std::uint64_t average = 1;  ///< media per picture, whose autocorrelations are averaged
  CameraNoise noise;
  Detector detector;
  /// Times within the exposure of a frame, at which the fields are computed; none for a medium at
  /// rest.
  FieldChanges exposure;
  std::size_t lags = 0;  ///< side of the recovered pictures, in pixels
  PhaseTask phases;
  double least_similarity = 0;  ///< structural similarity above which a recovery is a success
  std::uint64_t prediction_paths = 0, draws = 0;
  std::uint64_t seed = 1;
  int threads = 1;

  PictureSize size() const { return {lags, lags}; }
  /// Returns the noise of the detector's values, relative to their mean.
  CameraNoise detected() const { return detected_noise(noise, detector); }
};

/// A picture recovered from simulated frames, and its comparison with the true picture.
struct SimulatedPicture : RecoveredPicture {
  Frames frames;              ///< of all media
  double saturated = 0;       ///< fraction of the pixels that are saturated
  double light_contrast = 0;  ///< contrast of the light of the first medium, before camera noise
  PictureScore score;
};

/// Returns the number of light paths per field: with fewer, the excess kurtosis would exceed 0.01,
/// or a speckle grain would have fewer than four contributions of paths.
std::uint64_t paths_for_pictures(const PictureScene& scene, std::uint64_t seed, int threads);

/// Draws the fields [change][point][pixel] by `paths` light paths, which all points and times share
/// (CameraProducts). Computes no intensities.
FieldDraw picture_fields(const PictureScene& scene, const PictureTask& task, std::uint64_t paths);

/// Returns the sum over the points of brightness times |u|^2, averaged over the times of the
/// exposure and divided by its mean over the pixels. field: [change][point][pixel].
std::vector<double> incoherent_picture(std::span<const Complex> field,
                                       std::span<const double> brightness, std::size_t changes);

/// Simulates all frames and recovers pictures from them. truth: the true picture. grain: full width
/// at half maximum of the autocorrelation of speckle, in pixels. Throws Interrupted after a signal.
std::vector<SimulatedPicture> simulated_pictures(const PictureScene& scene, const PictureTask& task,
                                                 const FieldDraw& draw,
                                                 const std::vector<double>& truth, double grain);

/// Returns the width of windows of structural similarity, and of a point in a recovered picture: a
/// picture of phase retrieval is the object convolved with a function whose autocorrelation is that
/// of speckle.
double point_width_of(double grain);

}  // namespace flatspeckle::mc
