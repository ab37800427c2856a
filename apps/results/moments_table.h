#pragma once

#include <string>

#include "core/numbers/statistics.h"
#include "flatland/request/request.h"
#include "mc/paths/dynamics/brownian.h"
#include "mc/paths/estimators/gradient.h"
#include "mc/theory/moments_datasets.h"

namespace flatspeckle::apps {

/// A value to five digits; the imaginary part is left out where it is rounding.
std::string shown_value(Complex value);
/// Light and view angle of a channel; beams, sources and sensors by their numbers, sensors that
/// move by their place.
std::string shown_channel(const CovarianceRequest& request, std::uint32_t channel);

/// How many of the entries to show: intensities of moved fields are only there for the
/// correlation.
std::size_t shown_entries(const CovarianceRequest& request);

/// At most this many rows of a table are printed.
inline constexpr std::size_t most_rows = 60;

/// Prints the covariance entries of a request, or what goes with each of them, with their errors.
void print_entries(const CovarianceRequest& request, const Estimate& estimate,
                   const std::string& name = "covariance");

/// Prints the RMS error, which a target error is compared with, and the largest error of a single
/// entry: relative to it or, where that is larger, to the root of the product of its intensities.
void print_errors(const CovarianceRequest& request, const Estimate& estimate);

/// The ranges of a group of a file (empty: the root), and on standard error which rest on too few
/// steps.
void print_ranges(const std::string& group, const std::vector<mc::WrittenMoves>& groups);
/// C_E and C_I = C_E^2 of a curve of tilts or translations, then its range, for each of its
/// view_groups(). Of a map over tilts and shifts the ranges alone.
void print_moves(const CovarianceRequest& request, const std::vector<mc::WrittenMoves>& groups);
/// "1.36 +- 0.01", or which steps are missing.
std::string range_text(const mc::Range& range, double error);

/// Derivatives of the entries, and of the range where it is not censored.
void print_gradient(const CovarianceRequest& request, const mc::GradientJob& job,
                    const mc::GradientEstimates& gradient);

/// A channel that changes, or a tilt, of a request for changes.
std::string shown_change(const CovarianceRequest& request, std::size_t number);
/// The correlation after each change (a delay, a shift), of channels or of tilts.
void print_changes(const CovarianceRequest& request, const char* change,
                   const std::vector<double>& sizes, const Estimate& correlation,
                   const char* what = "correlation");

}  // namespace flatspeckle::apps
