#pragma once

#include <cstdint>
#include <span>
#include <vector>

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

/// A positive object on a line, blurred by the width of a speckle grain. Its position is arbitrary,
/// and it may be mirrored.
struct PhasedPicture {
  std::vector<double> picture;  ///< value at each pixel; the sum is 1
  /// At each iteration: rms of those values of the estimate that are negative or beyond the lags,
  /// divided by the rms of the whole estimate.
  std::vector<double> residual;
};

/// Retrieves an object from its autocorrelation, given by lag in pixels [fienup1982]. The object
/// must be shorter than the number of lags. In one dimension several objects generally have the
/// same autocorrelation, and different starts find different ones.
PhasedPicture retrieved_phases(std::span<const double> autocorrelation, const PhaseTask& task);

/// Returns the normalised sum of products of two pictures at the best shift, mirrored or not; 1 if
/// they are proportional.
double best_correlation(std::span<const double> truth, std::span<const double> picture);

}  // namespace flatspeckle::mc
