#pragma once

#include <cstdint>
#include <vector>

#include "mc/jobs/decay_curve.h"
#include "mc/jobs/path_job.h"

namespace flatspeckle::mc {

/// Changes (delays or frequency shifts) at which the squared correlations of all channels fall to a
/// level. `censored` is Range::Censoring as a number; the value of a censored crossing is its
/// bound, with error 0.
struct Crossings {
  Estimate value;                       ///< [channel]
  std::vector<std::uint64_t> censored;  ///< [channel]
  bool few_steps = false;  ///< whether a crossing is interpolated with fewer than four steps below
};

/// Returns the steps on the side of positive ones or, if there are none, the magnitudes of the
/// negative ones. Other steps become 0, which DecayCurve ignores.
std::vector<double> one_side(std::vector<double> steps);

/// Returns the squared magnitude of the correlation of a channel over the steps, from the
/// quantities of a job for an intensity request, [1 + step][channel], of which the first is the
/// intensity.
std::vector<double> squared_correlation(std::span<const Complex> all, std::size_t channels,
                                        std::size_t channel);

/// Returns the smallest steps at which the squared correlations of an intensity request fall to
/// `level`.
Crossings crossings(const CovarianceRequest& request, const PathJob& job, const GroupedSums& sums,
                    const std::vector<double>& steps, double level);

/// Meaning of Crossings::censored, for tables of datasets.
inline constexpr const char* crossing_meaning =
    "0: interpolated; 1: above the last value; 2: below the first value";

}  // namespace flatspeckle::mc
