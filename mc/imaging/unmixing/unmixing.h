#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "core/result/dataset_row.h"
#include "core/result/invariant.h"
#include "core/result/result_file.h"
#include "mc/imaging/recovery/camera_noise.h"
#include "mc/imaging/recovery/line_object.h"

namespace flatspeckle::mc {

/// Frames of sources that are bright in some and dark in others: frames = pattern * brightness^T,
/// both not negative.
struct NonnegativeFactors {
  Eigen::MatrixXd pattern;     ///< [pixel][source], the mean over the pixels 1
  Eigen::MatrixXd brightness;  ///< [frame][source]
  double residual = 0;  ///< rms of what the frames differ by from the product, over their rms
  /// By what part one factor common to all of the product would have to change for least squares.
  Invariant scale;
};

/// How the factors are improved.
struct FactorTask {
  std::size_t sources = 1;
  int iterations = 3000;  ///< at most
  double settled = 1e-5;  ///< stops where an iteration lowers the residual by less than this part
};

/// frames: [pixel][frame]. Hierarchical alternating least squares (Cichocki and Phan 2009), several
/// sweeps over each factor while the other stands (Gillis and Glineur 2012). They begin with the
/// pixels in which a single source prevails, by successive projection (Araujo et al. 2001): speckle
/// has dark places everywhere, so that each source has pixels nearly of its own, and factors are
/// unique but for their order.
NonnegativeFactors nonnegative_factors(const Eigen::MatrixXd& frames, const FactorTask& task);

/// Two sources whose patterns are alike where one is shifted.
struct PatternShift {
  std::size_t first = 0, second = 0;
  double shift = 0;   ///< pixels from the first's pattern to the second's
  double height = 0;  ///< of the correlation there, C_I for speckle
  double noise = 0;   ///< its standard deviation elsewhere
};

/// Of all pairs whose correlation has a peak, within `lags` pixels, that chance makes in one of a
/// hundred such sets. patterns: [pixel][source].
std::vector<PatternShift> pattern_shifts(const Eigen::MatrixXd& patterns, std::size_t lags);

/// Where sources are that are joined by pairs, one to the next.
struct SourcePlaces {
  std::vector<double> x;           ///< pixels, the first of each group at 0
  std::vector<std::size_t> group;  ///< sources of one number are joined; 0: the largest
};

/// The tree of the highest peaks that reaches all it can, then least squares over the pairs that
/// agree with it within so many pixels, each weighted by its peak's square. An object may so be
/// longer than any two points share their speckle (Zhu et al. 2022).
SourcePlaces source_places(std::size_t sources, const std::vector<PatternShift>& shifts,
                           double within);

/// How many sources frames have.
struct SourceCount {
  std::vector<double> singular_values;  ///< of the frames, their noise white, largest first
  double threshold = 0;                 ///< what noise alone does not exceed
  std::size_t sources = 0;              ///< singular values above it
};

/// light: of frames, [pixel][frame], its mean 1, without the background. Where the camera is known,
/// rows and columns are scaled so that the noise of every one has the variance 1 in the mean
/// (biwhitening, Landa, Zhang and Kluger 2022); the largest singular value of such noise is
/// sqrt(pixels) + sqrt(frames), with 99 of 100 below the quantile of Tracy and Widom's distribution
/// (Johnstone 2001). Without photons noise is taken to be white: what exceeds it so far that it
/// helps is known from the median singular value (Gavish and Donoho 2014), where fewer than half as
/// many sources as frames are bright. Not below 1e-6 of the largest, where rounding is.
SourceCount source_count(const Eigen::MatrixXd& light, const CameraNoise& noise);

/// What is looked for in frames of one medium whose sources blink.
struct UnmixingTask {
  CameraNoise noise = {};        ///< of each frame
  std::size_t lags = 0;          ///< pixels: longer shifts of two patterns are not looked for
  std::size_t sources = 0;       ///< 0: as many as the singular values tell
  double resolution_grains = 1;  ///< shifts agree within so many
};

/// Sources from frames.
struct Unmixed {
  SourceCount count;
  NonnegativeFactors factors;
  SourcePlaces places;
  double grain = 0;  ///< of the patterns, pixels

  /// Of the largest group, in pixels; brightness: mean over the frames, the mean over the
  /// sources 1.
  LineObject object() const;
};

/// Frames of the same pixels. The factorisation (Zhu et al. 2022: fluctuating sources, patterns by
/// non-negative factors, places by their correlations) is of the light alone, in units of its mean.
/// Throws InputError for frames without light, as without_envelope(), and for fewer frames than
/// sources.
Unmixed unmixed(std::span<const std::vector<double>> frames, const UnmixingTask& task);

extern const DatasetTable unmixing_table;

/// Of frames of these names.
void write_unmixed(ResultFile& file, const std::vector<std::string>& names, const Unmixed& found);

}  // namespace flatspeckle::mc
