#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "core/numbers/complex.h"
#include "core/numbers/random.h"
#include "core/numbers/statistics.h"
#include "mc/imaging/blinking.h"
#include "mc/imaging/camera_exposure.h"
#include "mc/imaging/line_camera.h"
#include "mc/theory/detector_noise.h"
#include "mc/imaging/recovery/deconvolution.h"
#include "mc/imaging/recovery/image_score.h"
#include "mc/imaging/recovery/line_object.h"
#include "mc/imaging/recovery/recovery.h"
#include "mc/paths/speckle/speckle_field.h"

namespace flatspeckle::mc {

/// Returns the sum over the points n of brightness_n |u_n|^2. field: [point][pixel].
std::vector<double> sum_of_intensities(std::span<const Complex> field,
                                       std::span<const double> brightness);

/// Returns sum_of_intensities() divided by its mean over the pixels.
std::vector<double> incoherent_sum(std::span<const Complex> field,
                                   std::span<const double> brightness);

/// Returns C_I of each pair of points, averaged over places on the camera. entries: for each place
/// and pair the covariance of two fields, then their two intensities, [place][pair][3].
std::vector<Complex> mean_correlations(std::span<const Complex> entries, std::size_t places);

/// Statistics of a frame that determine the noise of its autocorrelation.
struct FrameGrains {
  double grains = 0;       ///< number of independent grains in the frame
  CameraNoise noise = {};  ///< noise of the camera
  double pixels = 1;
};

/// Returns, for each pair of points, the height of its peak in the autocorrelation, divided by the
/// noise of the autocorrelation. For points of brightness b, the peak of a pair is a_ij = C_I b_i
/// b_j / (sum of b)^2, and the peak at lag 0 is a_0 = (sum of b^2) / (sum of b)^2; both are divided
/// by (1 + background)^2. The noise comes from all peaks and from the camera, whose noise has the
/// variance w and contributes only at lag 0. By Bartlett's formula, for pairs at distinct
/// distances, it is sqrt((a_0^2 + 2 sum of a_ij^2) / grains + (2 a_0 w + w^2) / pixels). For N
/// equal points with equal C_I and no camera noise, the result is C_I sqrt(grains) / N / sqrt(1 +
/// C_I^2 (1 - 1/N)).
std::vector<double> peaks_over_noise(const LineObject& object,
                                     const std::vector<double>& correlation,
                                     const FrameGrains& frame);

/// Returns the same ratios for the filtered autocorrelation of pair_peaks(), in which points are
/// searched. With the symbols of peaks_over_noise(), the filter is H = T / P with P = a_0 T + w. T
/// is the power spectrum of speckle of unit variance, which ends at `band` cycles per pixel. The
/// variance of the noise is the integral of H^2 ((a_0^2 + 2 sum of a_ij^2) T^2 + 2 a_0 w T + w^2) /
/// pixels, divided by the square of the integral of H T.
std::vector<double> filtered_peaks_over_noise(const LineObject& object,
                                              const std::vector<double>& correlation,
                                              const FrameGrains& frame, double band);

/// Parameters of the simulation of frames and of their evaluation.
struct ImagingTask {
  /// Search for the points. Its resolution is also the tolerance of the scores.
  RecoveryTask recovery;
  DeconvolutionTask deconvolution;  ///< used if the scene has a reference
  BlinkingTask blinking;            ///< used if points blink
  std::uint64_t repeats = 1;  ///< number of repeats, each with independent media; 0: no frames
  std::uint64_t average = 1;  ///< number of media per repeat, whose autocorrelations are averaged
  std::uint64_t seed = 1;
  int threads = 1;
};

/// Results of one repeat, which has one medium or several. `frame` belongs to the first medium;
/// estimates use the frames of all media.
struct ImagedMedium : Recovered {
  /// Frame of the object; frame of the reference alone, if there is one.
  std::vector<double> frame, reference;
  Deconvolved deconvolved;
  double psnr = 0;  ///< peak signal-to-noise ratio of the deconvolved picture, in dB
  ImageScore score;
  Blinked blinked;  ///< if points blink; its frames, whose mean is `frame`, are kept only in the
                    ///< first repeat
  /// E|u|^4 / (E|u|^2)^2 of the fields of the points; 2 for Gaussian fields.
  double fourth_moment = 0;
};

/// Simulates all frames and evaluates them. A frame depends on the number of its medium, the seed
/// and the scene, not on the number of threads. draw: draws the fields of line.scene,
/// [point][pixel]. This and the following functions throw Interrupted after a signal.
std::vector<ImagedMedium> imaged(const LineScene& line, const ImagingTask& task,
                                 const FieldDraw& draw);

/// Expected correlations, computed without frames. C_I of two points is |C|^2/(I I') for the
/// covariance C and the intensities I, I' of their fields at two places of the camera. The places
/// differ by the shift between the two speckle patterns.
struct ImagingPrediction {
  std::vector<double> distance;  ///< distances of the pairs of points (0, 1), (0, 2), ...
  Estimate correlation;          ///< C_I of these pairs
  Estimate to_reference;         ///< C_I between each point and the reference
};

/// Estimates the correlations from `paths` light paths, averaged over places along the whole
/// camera. label: name in the progress output; if it is empty, no progress is shown.
ImagingPrediction predicted(const LineScene& line, std::uint64_t paths, std::uint64_t seed,
                            int threads, const char* label = "correlations");

/// Returns the number of light paths that are summed for each field. A pilot run with a few pixels
/// gives the number for which the excess kurtosis of the field is 0.01. The result is at least four
/// times most_grains(); with fewer paths, the positions of the path endpoints would be visible in
/// the autocorrelation of the frame.
std::uint64_t paths_for_fields(const LineScene& line, std::uint64_t seed, int threads);

}  // namespace flatspeckle::mc
