#pragma once

#include <vector>

#include "core/result/dataset_row.h"
#include "core/result/result_file.h"
#include "mc/jobs/changed_fields.h"

namespace flatspeckle::mc {

/// Recording of speckle with an exposure time T while the scatterers move (laser speckle contrast
/// imaging). If g1(tau) is the field correlation after a delay tau, the squared contrast is
///   K^2(T) = (2 beta / T) int_0^T |g1(tau)|^2 (1 - tau / T) dtau.
struct Exposure {
  std::vector<double> times;  ///< exposure times T, in the unit of the delays
  /// K^2 if the scatterers do not move. It is below 1 if a pixel contains several speckles or
  /// polarizations.
  double beta = 1;
};

/// Throws InputError if an exposure time exceeds the longest delay, or if fewer than four delays
/// are shorter than an exposure time.
void check_exposure(const Exposure& exposure, const std::vector<double>& delays);

/// Returns estimates of K^2, [exposure time][channel].
Estimate squared_contrast(const CovarianceRequest& request, const PathJob& job,
                          const GroupedSums& sums, const std::vector<double>& delays,
                          const Exposure& exposure);

/// Returns K^2 (see Exposure) for the exposure time `time` and beta = 1. squares: |g1|^2 at the
/// delays, normalised to 1 at delay 0 and interpolated by DecayCurve.
double exposed(const std::vector<double>& delays, const std::vector<double>& squares, double time);

/// Returns delays at which |g1|^2 must be given so that exposed() computes K^2 at these exposure
/// times with an error of 3e-4. This error holds for the decays for which exposed() is exact, for
/// Gaussian decays and for the decays of slabs.
std::vector<double> exposure_delays(const std::vector<double>& times);

extern const DatasetTable contrast_table;
void write_contrast(ResultFile& file, const Exposure& exposure, const Estimate& contrast);

}  // namespace flatspeckle::mc
