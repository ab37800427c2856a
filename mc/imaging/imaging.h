#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "core/numbers/complex.h"
#include "core/numbers/random.h"
#include "core/numbers/statistics.h"
#include "mc/imaging/blinking.h"
#include "mc/imaging/line_camera.h"
#include "mc/imaging/recovery/camera_noise.h"
#include "mc/imaging/recovery/deconvolution.h"
#include "mc/imaging/recovery/image_score.h"
#include "mc/imaging/recovery/line_object.h"
#include "mc/imaging/recovery/recovery.h"
#include "mc/paths/speckle/speckle_field.h"

namespace flatspeckle::mc {

/// sum over the points n of brightness_n |u_n|^2. field: [point][pixel].
std::vector<double> sum_of_intensities(std::span<const Complex> field,
                                       std::span<const double> brightness);

/// The same over its mean.
std::vector<double> incoherent_sum(std::span<const Complex> field,
                                   std::span<const double> brightness);

/// The frame as the camera has it.
void expose(std::vector<double>& frame, const CameraNoise& noise, RandomStream& random);

/// What a frame is measured by.
struct FrameGrains {
  double grains = 0;       ///< independent ones in it
  CameraNoise noise = {};  ///< of its
  double pixels = 1;
};

/// Heights of the pairs' peaks in the autocorrelation over its noise. A peak is a_ij = C_I b_i b_j
/// / (sum of b)^2, that at lag 0 a_0 = (sum of b^2) / (sum of b)^2, both less by (1 +
/// background)^2; the noise of an estimated autocorrelation is that of all its peaks and of the
/// camera, whose variance w stands at lag 0 alone: sqrt((a_0^2 + 2 sum of a_ij^2) / grains + (2 a_0
/// w + w^2) / pixels) (Bartlett's formula; distances distinct). For N equal points of C_I without
/// camera that is C_I sqrt(grains) / N / sqrt(1 + C_I^2 (1 - 1/N)).
std::vector<double> peaks_over_noise(const LineObject& object,
                                     const std::vector<double>& correlation,
                                     const FrameGrains& frame);

/// As peaks_over_noise(), in the filtered autocorrelation that is searched (pair_peaks()). The
/// filter has H = T / P, P = a_0 T + w, T the power of speckle of unit variance in `band` cycles
/// per pixel: the peaks' variance is the integral of H^2 ((a_0^2 + 2 sum of a_ij^2) T^2 + 2 a_0 w T
/// + w^2) / pixels, over the square of the integral of H T.
std::vector<double> filtered_peaks_over_noise(const LineObject& object,
                                              const std::vector<double>& correlation,
                                              const FrameGrains& frame, double band);

/// What is done with each of the media that a scene stands for.
struct ImagingTask {
  RecoveryTask recovery;            ///< its resolution is also what counts as found
  DeconvolutionTask deconvolution;  ///< where the scene has a reference
  BlinkingTask blinking;            ///< where points do
  std::uint64_t repeats = 1;        ///< 0: no frames
  std::uint64_t average = 1;        ///< media of each repeat, whose autocorrelations are averaged
  std::uint64_t seed = 1;
  int threads = 1;
};

/// One medium, or some of one repeat: the first's frame, and what all frames tell.
struct ImagedMedium : Recovered {
  std::vector<double> frame, reference;  ///< of the reference alone, where there is one
  Deconvolved deconvolved;
  double psnr = 0;  ///< of its picture
  ImageScore score;
  Blinked blinked;           ///< whose frames' mean is the frame; its own kept of the first medium
  double fourth_moment = 0;  ///< of the points' fields, E|u|^4 / (E|u|^2)^2: Gaussian, 2
};

/// All frames: number, seed and scene make them, no thread does. draw: fields of line.scene,
/// [point][pixel]. This and what follows throws Interrupted once a signal has come.
std::vector<ImagedMedium> imaged(const LineScene& line, const ImagingTask& task,
                                 const FieldDraw& draw);

/// What to expect without a picture. C_I of two points: |C|^2/(I I') of the one's light and of the
/// other's, at places of the camera that differ by how far the picture moves.
struct ImagingPrediction {
  std::vector<double> distance;  ///< of pairs of points, in the order (0, 1), (0, 2), ...
  Estimate correlation;          ///< C_I
  Estimate to_reference;         ///< C_I of each point and the reference
};

/// By so many light paths. Averaged over places all along the camera. label: of the progress, none
/// where it is empty.
ImagingPrediction predicted(const LineScene& line, std::uint64_t paths, std::uint64_t seed,
                            int threads, const char* label = "correlations");

/// Light paths of one field: as many as a pixel's excess kurtosis of 0.01 asks for, by a survey of
/// a few pixels, and four for each grain that can be seen, or the frame's autocorrelation would
/// show the places where the paths end.
std::uint64_t paths_for_fields(const LineScene& line, std::uint64_t seed, int threads);

}  // namespace flatspeckle::mc
