#pragma once

#include <vector>

#include "core/result/dataset_row.h"
#include "core/result/result_file.h"
#include "mc/jobs/changed_fields.h"

namespace flatspeckle::mc {

/// Speckle that is exposed for a time T while scatterers move (laser speckle contrast imaging):
///   K^2(T) = (2 beta / T) int_0^T |g1(tau)|^2 (1 - tau / T) dtau.
struct Exposure {
  std::vector<double> times;  ///< T, in units of the delays
  double beta = 1;            ///< K^2 of still scatterers: speckles per pixel, polarizations
};

/// Throws InputError where delays do not reach the times, or lie too far apart for them.
void check_exposure(const Exposure& exposure, const std::vector<double>& delays);

/// K^2, [time][channel].
Estimate squared_contrast(const CovarianceRequest& request, const PathJob& job,
                          const GroupedSums& sums, const std::vector<double>& delays,
                          const Exposure& exposure);

/// The same integral of any curve: squares at delays, of which 0 is known to have 1. Their
/// logarithm is interpolated by cubic polynomials of the delay's root: exact where they decay as
/// exp(-t), exp(-sqrt(t)) or their product.
double exposed(const std::vector<double>& delays, const std::vector<double>& squares, double time);

/// Delays from which K^2 of these times follows to 3e-4, of decays of these kinds, Gaussian ones
/// and those of slabs.
std::vector<double> exposure_delays(const std::vector<double>& times);

extern const DatasetTable contrast_table;
void write_contrast(ResultFile& file, const Exposure& exposure, const Estimate& contrast);

}  // namespace flatspeckle::mc
