#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/numbers/statistics.h"
#include "flatland/request/request.h"

namespace flatspeckle::mc {

/// The reference's views by what one field correlation sums over: those of one side of the medium,
/// transmitted before reflected; near sensors all together. One group or two.
std::vector<std::vector<std::size_t>> view_groups(const CovarianceRequest& request);

/// C_E per move (C19). Of far views |sum over views of the covariance of reference and moved
/// field|, over the square root of the product of their intensities summed over the same views.
/// Near sensors, whose covariances differ in phase, count by power: the square root of sum |C|^2
/// over sum I I'. A function of the covariance entries of a request with moves, whichever solver
/// they come from. Where an intensity vanishes the correlation is 0. views: one of the
/// view_groups().
std::vector<Complex> field_correlation(const CovarianceRequest& request,
                                       std::span<const Complex> entries,
                                       const std::vector<std::size_t>& views);
/// Of the first of the view_groups().
std::vector<Complex> field_correlation(const CovarianceRequest& request,
                                       std::span<const Complex> entries);

/// Half-width of an intensity-correlation curve.
struct Range {
  /// Where the tilts do not reach the half width, or leave it out.
  enum class Censoring { none, above_value, below_value };
  double value = 0;  ///< |q| where C_I = C_E^2 falls to 1/2; if censored the last or first tilt's
  Censoring censored = Censoring::none;
};

/// Censored above the last tilt if C_I does not fall to 1/2 there, and below the first one that is
/// not 0 if C_I has fallen already. Else the first crossing of C_I = 1/2 on the side of positive q
/// (of negative q where there is no positive one), by interpolation of C_I of degree five through
/// the six nearest tilts: to 1e-5 where they are spaced by a sixth.
Range memory_effect_range(const std::vector<double>& tilt_q, std::span<const Complex> correlation);

/// Steps between 0 and a range.
std::size_t steps_below(const std::vector<double>& steps, const Range& range);
/// Whether a range rests on so few steps below it that its error bar, which does not know what the
/// curve does between them, says too little.
bool few_steps(const std::vector<double>& steps, const Range& range);

/// A half-width and its jackknife error.
struct RangeEstimate {
  Range range;
  double error = 0;
  std::uint64_t rare = 0;  ///< see Estimate
};

/// field_correlation of every move and half-widths, with jackknife errors. The only range of
/// memory_effect and translation is that of their moves; those of tilt_shift are along tilts at
/// shift 0, along shifts at tilt 0, and of far views along matched views. Tilts count in tilt_q.
/// views: one of the view_groups().
struct Correlations {
  Estimate moves;
  std::vector<RangeEstimate> ranges;
};
Correlations correlations(const CovarianceRequest& request, const GroupedSums& sums,
                          const Estimator& covariance, const std::vector<std::size_t>& views);

/// field_correlation, then the values of those ranges, of the first of the view_groups().
std::vector<Complex> correlation_and_ranges(const CovarianceRequest& request,
                                            std::span<const Complex> entries);

/// Of a memory_effect or translation request, of the first of its view_groups().
struct MemoryEffect {
  std::vector<double> correlation, correlation_error;  ///< per tilt or shift
  std::vector<std::uint64_t> correlation_rare;         ///< see Estimate
  RangeEstimate range;
};
MemoryEffect memory_effect(const CovarianceRequest& request, const GroupedSums& sums,
                           const Estimator& covariance);

}  // namespace flatspeckle::mc
