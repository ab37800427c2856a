#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace flatspeckle::mc {

/// How phases are looked for that belong to an autocorrelation.
struct PhaseTask {
  std::int64_t starts = 20;       ///< from random phases; the best by its residual is taken
  std::int64_t iterations = 400;  ///< of each: three quarters hybrid input-output, then error
                                  ///< reduction
  double feedback = 0.9;          ///< of hybrid input-output
  double sparsity = 0.05;  ///< error reduction takes what is below this share of the largest for 0
  std::uint64_t seed = 1;
};

/// A positive object on a line, shifted and mirrored or not, as the frame blurs it.
struct PhasedPicture {
  std::vector<double> picture;   ///< by pixel, the sum 1
  std::vector<double> residual;  ///< rms of the spectrum's amplitude that positive objects within
                                 ///< the lags lack, over its rms, after each iteration
};

/// Of an autocorrelation by lag in pixels, whose object is shorter than the lags (Fienup 1982): a
/// line has in general several objects for one autocorrelation, which the starts then find in turn.
PhasedPicture retrieved_phases(std::span<const double> autocorrelation, const PhaseTask& task);

/// Correlation of two pictures about 0 at the best shift, mirrored or not.
double best_correlation(std::span<const double> truth, std::span<const double> picture);

}  // namespace flatspeckle::mc
