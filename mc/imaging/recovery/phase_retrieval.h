#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/keys/keys.h"

namespace flatspeckle::mc {

/// Settings of phase retrieval from an autocorrelation.
struct PhaseTask {
  /// Number of random starts; the result of smallest residual is returned.
  std::int64_t starts = 20;
  /// Iterations of each start. Three quarters are hybrid input-output, the rest error reduction.
  std::int64_t iterations = 400;
  double feedback = 0.9;   ///< feedback parameter of hybrid input-output
  double sparsity = 0.05;  ///< error reduction sets values below this fraction of the largest to 0
  std::uint64_t seed = 1;
};
void add_keys(Keys& keys, PhaseTask& task);
PhaseTask phase_task(const Keys& keys, const PhaseTask& values);

/// Numbers of rows and columns of a picture. A line has one row.
struct PictureSize {
  std::size_t rows = 1, columns = 0;
  std::size_t pixels() const { return rows * columns; }
};

/// A positive object, blurred by a speckle grain. Its position is arbitrary, and it may be rotated
/// by 180 degrees; on a line, it may be mirrored.
struct RetrievedPicture {
  std::vector<double> picture;  ///< [y][x]; the sum is 1
  /// At each iteration: rms of those values of the estimate that are negative or outside the
  /// picture, divided by the rms of the whole estimate.
  std::vector<double> residual;
  /// Mean correlation (best_alignment()) between this picture and those of the better half of the
  /// other starts, by their residual: confidence in the picture; 1 with a single start.
  double agreement = 1;
};

/// Retrieves an object from its autocorrelation, by hybrid input-output and error reduction from
/// several random starts [fienup1982]. autocorrelation: at lags from -(rows - 1) to rows - 1 and
/// -(columns - 1) to columns - 1, [y][x]. The object must be smaller than `size`. Returns the
/// picture of smallest residual. On a line, several objects generally have the same
/// autocorrelation, and different starts find different ones.
RetrievedPicture retrieved_picture(std::span<const double> autocorrelation, PictureSize size,
                                   const PhaseTask& task);

/// Improves a picture, which is then the only start, by error reduction alone. Its agreement is its
/// correlation with the given picture.
RetrievedPicture refined_picture(std::span<const double> autocorrelation, PictureSize size,
                                 const PhaseTask& task, const std::vector<double>& start);

/// Retrieves an object on a line from its autocorrelation at lags from 0 on.
RetrievedPicture retrieved_line(std::span<const double> autocorrelation, const PhaseTask& task);

/// Shift, after a rotation by 180 degrees or not, at which a picture b agrees best with a.
struct Alignment {
  /// Normalised sum of products of the pictures; 1 if they are proportional.
  double correlation = 0;
  bool rotated = false;
  long y = 0, x = 0;  ///< offset of the picture b, after the rotation

  /// Returns the picture b, rotated and shifted; values from outside are 0.
  std::vector<double> applied(std::span<const double> b, PictureSize size) const;
};
Alignment best_alignment(std::span<const double> a, std::span<const double> b, PictureSize size);

}  // namespace flatspeckle::mc
