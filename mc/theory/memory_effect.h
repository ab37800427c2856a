#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/numbers/statistics.h"
#include "flatland/request/request.h"

namespace flatspeckle::mc {

/// Groups the reference views. A field correlation averages over the views of one group. Far views form
/// a group for each side of the medium, transmission before reflection; near sensors form a single
/// group. There are one or two groups.
std::vector<std::vector<std::size_t>> view_groups(const CovarianceRequest& request);

/// Returns the field correlation C_E of every move (tilt, shift or translation; C19) of a request,
/// from its covariance entries, which any solver may have computed. In each view, C is the
/// covariance of the reference and the moved field, and I and I' are their intensities. C_E is
/// sqrt(sum |C|^2 / sum I I'), because the phase of C differs between views. C_E is 0 if the
/// denominator is 0. views: the views of the sum, one of the view_groups().
std::vector<Complex> field_correlation(const CovarianceRequest& request,
                                       std::span<const Complex> entries,
                                       const std::vector<std::size_t>& views);
/// Returns the same C_E for the first of the view_groups().
std::vector<Complex> field_correlation(const CovarianceRequest& request,
                                       std::span<const Complex> entries);

/// Half-width of an intensity-correlation curve.
struct Range {
  /// Whether the half-width lies beyond the last tilt (above_value) or before the first
  /// (below_value).
  enum class Censoring { none, above_value, below_value };
  /// |q| at which C_I = C_E^2 falls to 1/2; if censored, |q| of the last or first tilt
  double value = 0;
  Censoring censored = Censoring::none;
};

/// Returns the half-width: the smallest |q| at which C_I falls to 1/2, on the side of positive q,
/// or of negative q if there is no positive one. The result is censored as above_value if C_I
/// exceeds 1/2 at all tilts, and as below_value if C_I is at most 1/2 at the first nonzero tilt.
/// C_I is interpolated by a polynomial of degree five through the six nearest tilts; the half-width
/// is accurate to 1e-5 if neighbouring tilts differ by a sixth of it.
Range memory_effect_range(const std::vector<double>& tilt_q, std::span<const Complex> correlation);

/// Tilt of the light at a range |q|: its rotation about an axis in the faces (C55), and the angle
/// between the beams before and after it, each with its derivative by q.
struct RangeTilt {
  double rotation = 0, rotation_per_q = 0, between = 0, between_per_q = 0;
};

/// Returns the tilt at which the transverse wavenumber of the light, with the wavenumber k outside,
/// has changed by a range in the direction of the tilts.
RangeTilt tilt_of_range(const CovarianceRequest& request, double k, double range);
/// Whether the angle between the beams differs from the rotation: oblique light that is not tilted
/// in its plane of incidence.
bool is_tilted_aside(const CovarianceRequest& request);

/// Returns the number of steps (tilts or shifts, without 0) whose magnitude is below the
/// half-width.
std::size_t steps_below(const std::vector<double>& steps, const Range& range);
/// Whether fewer than four steps have a magnitude below the half-width. The error bar of the
/// half-width is then too small, because it does not include the error of interpolation between
/// steps.
bool few_steps(const std::vector<double>& steps, const Range& range);

/// A half-width and its jackknife error.
struct RangeEstimate {
  Range range;
  double error = 0;
  std::uint64_t rare = 0;  ///< see Estimate
};

/// Field correlations C_E of every move (tilt, shift or translation) and the half-widths (ranges)
/// of their curves, with jackknife errors. The errors of C_E include the mean excess of C_E that
/// noise causes. Requests of kind memory_effect and translation have one
/// range. Requests of kind tilt_shift have a range along tilts at shift 0, one along shifts at tilt
/// 0, and, for far views, one along tilts with matched views. Ranges along tilts are values of
/// CovarianceRequest::tilt_q.
struct Correlations {
  Estimate moves;
  std::vector<RangeEstimate> ranges;
};
/// views: one of the view_groups().
Correlations correlations(const CovarianceRequest& request, const GroupedSums& sums,
                          const Estimator& covariance, const std::vector<std::size_t>& views);

/// Returns field_correlation() for the first of the view_groups(), then the values of the ranges of
/// these correlations (Correlations::ranges).
std::vector<Complex> correlation_and_ranges(const CovarianceRequest& request,
                                            std::span<const Complex> entries);

/// Results of a memory_effect or translation request, for the first of its view_groups().
struct MemoryEffect {
  std::vector<double> correlation, correlation_error;  ///< per tilt or shift
  std::vector<std::uint64_t> correlation_rare;         ///< see Estimate
  RangeEstimate range;
};
MemoryEffect memory_effect(const CovarianceRequest& request, const GroupedSums& sums,
                           const Estimator& covariance);

}  // namespace flatspeckle::mc
