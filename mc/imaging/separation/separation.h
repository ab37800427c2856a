#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "core/result/dataset_row.h"
#include "core/result/invariant.h"
#include "core/result/result_file.h"
#include "mc/theory/detector_noise.h"
#include "mc/imaging/recovery/line_object.h"

namespace flatspeckle::mc {

/// Non-negative factorisation of frames, frames = pattern * brightness^T. The sources must be
/// bright in some frames and dark in others.
struct NonnegativeFactors {
  Eigen::MatrixXd pattern;     ///< [pixel][source]; the mean over the pixels is 1
  Eigen::MatrixXd brightness;  ///< [frame][source]
  /// Rms difference between frames and product, divided by the rms of the frames.
  double residual = 0;
  /// Check of convergence: |t - 1|, where multiplying the product by t would minimise the residual.
  Invariant scale;
};

/// Settings of the iteration that improves the factors.
struct FactorTask {
  std::size_t sources = 1;
  int iterations = 3000;  ///< largest number of iterations
  /// Stops if an iteration reduces the squared residual by less than this fraction.
  double settled = 1e-5;
};

/// Factorises frames, [pixel][frame], by hierarchical alternating least squares [cichocki2009],
/// with several sweeps over one factor while the other is fixed [gillis2012]. The iteration starts
/// from pixels in which a single source dominates, found by successive projection [araujo2001].
/// Such pixels exist because speckle has dark places everywhere; they make the factors unique up to
/// the order of the sources.
NonnegativeFactors nonnegative_factors(const Eigen::MatrixXd& frames, const FactorTask& task);

/// Two sources whose patterns agree if one is shifted.
struct PatternShift {
  std::size_t first = 0, second = 0;
  double shift = 0;    ///< shift of the second pattern relative to the first along x, in pixels
  double height = 0;   ///< correlation of the patterns at this shift; C_I for speckle
  double noise = 0;    ///< standard deviation of the correlation at other shifts
  double shift_y = 0;  ///< shift along y, in rows; 0 for lines
};

/// Finds all pairs of patterns, [pixel][source], whose correlation has a significant peak at a
/// shift of less than `lags` pixels along each axis. Noise alone would produce such a peak in one
/// of a hundred sets of patterns. rows: number of rows of the pixels, [y][x]; 1 for lines.
std::vector<PatternShift> pattern_shifts(const Eigen::MatrixXd& patterns, std::size_t lags,
                                         std::size_t rows = 1);

/// Positions of sources, in groups that are connected by pairs with known shifts.
struct SourcePlaces {
  /// Positions in pixels; the first source of each group is at 0. On lines y is 0.
  std::vector<double> x, y;
  /// Sources with the same number are connected; 0: the largest group.
  std::vector<std::size_t> group;
};

/// Connects the sources to trees by the pairs with the highest peaks, which gives first positions.
/// Then fits the positions by least squares to all pairs that agree with these within `within`
/// pixels, weighted by the squares of their peaks. Because sources may be connected through others,
/// an object may be longer than the range within which two points share their speckle [zhu2022].
SourcePlaces source_places(std::size_t sources, const std::vector<PatternShift>& shifts,
                           double within);

/// Number of sources in frames, determined from singular values.
struct SourceCount {
  std::vector<double> singular_values;  ///< singular values of the whitened frames, largest first
  double threshold = 0;                 ///< level that noise alone does not exceed
  std::size_t sources = 0;              ///< number of singular values above the threshold
};

/// Counts the sources. light: frames without background, [pixel][frame], with mean 1. If the
/// camera's noise is known, rows and columns are scaled so that the noise in each of them has the
/// mean variance 1 (biwhitening, Landa, Zhang and Kluger [landa2022]). The largest singular value
/// of such noise is about sqrt(pixels) + sqrt(frames). The threshold is the value that it exceeds
/// in one of 100 cases, a quantile of the Tracy-Widom distribution [johnstone2001]. If
/// noise.photons is 0, the noise is assumed to be white, and the threshold follows from the median
/// singular value [gavish2014]. This is valid if the number of bright sources is less than half the
/// number of frames. The threshold is at least 1e-6 of the largest singular value, to exclude
/// rounding errors.
SourceCount source_count(const Eigen::MatrixXd& light, const CameraNoise& noise);

/// Parameters of the separation of blinking sources in frames of one medium.
struct SeparationTask {
  CameraNoise noise = {};        ///< noise in each frame
  std::size_t lags = 0;          ///< longest shift between two patterns that is searched, in pixels
  std::size_t sources = 0;       ///< number of sources; 0: determined from the singular values
  double resolution_grains = 1;  ///< tolerance in grains within which shifts agree
  std::size_t rows = 1;          ///< rows of the frames, [y][x]; 1 for lines
};

/// Sources separated from frames.
struct SeparatedSources {
  SourceCount count;
  NonnegativeFactors factors;
  SourcePlaces places;
  double grain = 0;      ///< mean grain size of the patterns in pixels
  std::size_t rows = 1;  ///< rows of the frames

  /// Returns the sources of the largest group on a line, in pixels. brightness: mean over the
  /// frames, with mean 1 over the sources.
  LineObject object() const;
};

/// Separates fluctuating sources from frames with the same number of pixels, by the method of Zhu
/// et al. [zhu2022]: non-negative factorisation yields the patterns, and the correlations of the
/// patterns yield the positions. The factorisation uses the light without background, in units of
/// its mean. Throws InputError for frames without light, if without_envelope() does, and for fewer
/// frames than sources.
SeparatedSources separated_sources(std::span<const std::vector<double>> frames,
                                   const SeparationTask& task);

extern const DatasetTable separation_table;

/// Writes the sources that were separated from frames. names: names of the frames.
void write_separation(ResultFile& file, const std::vector<std::string>& names,
                      const SeparatedSources& found);

}  // namespace flatspeckle::mc
