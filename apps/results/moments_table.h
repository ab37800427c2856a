#pragma once

#include <string>

#include "core/numbers/statistics.h"
#include "flatland/request/request.h"
#include "mc/paths/dynamics/brownian.h"
#include "mc/paths/estimators/gradient.h"
#include "mc/theory/moments_datasets.h"

namespace flatspeckle::apps {

/// Returns a value as text with five digits, without the imaginary part if it is a rounding error.
std::string shown_value(Complex value);
/// Returns the light and the view of a channel as text: angles, indices of beams, sources and
/// sensors, or positions of moved sensors.
std::string shown_channel(const CovarianceRequest& request, std::uint32_t channel);

/// Returns the number of covariance entries to print. The intensities of moved (tilted, shifted or
/// translated) fields, which only normalise the correlation, are not printed.
std::size_t shown_entries(const CovarianceRequest& request);

/// Largest number of printed rows of a table.
inline constexpr std::size_t most_rows = 60;

/// Prints the covariance entries of a request, or other values of each entry (called `name`), with
/// errors.
void print_entries(const CovarianceRequest& request, const Estimate& estimate,
                   const std::string& name = "covariance");

/// Prints the relative RMS error, which is the one compared with a target error, and the largest
/// error of a single entry. The latter is relative to the entry or, if larger, to the geometric
/// mean of the intensities of its two channels.
void print_errors(const CovarianceRequest& request, const Estimate& estimate);

/// Prints the memory-effect ranges that are written in a group of the result file (in the root if
/// `group` is empty). Prints a note on standard error for each range that is computed from too few
/// tilts or shifts.
void print_ranges(const std::string& group, const std::vector<mc::WrittenMoves>& groups);
/// Prints the correlations C_E and C_I = C_E^2 over tilts or translations, and their memory-effect
/// range, for each of the view_groups(). For a map over both tilts and shifts, prints only the
/// ranges.
void print_moves(const CovarianceRequest& request, const std::vector<mc::WrittenMoves>& groups);
/// Returns a range with its error as text, such as "1.36 +- 0.01". If the curve does not cover the
/// range (censored), returns a bound of it.
std::string range_text(const mc::Range& range, double error);

/// Prints the derivatives of the covariance entries, and of the memory-effect range unless only a
/// bound of it is known.
void print_gradient(const CovarianceRequest& request, const mc::GradientJob& job,
                    const mc::GradientEstimates& gradient);

/// Returns the channel or tilt of this number as text, for the rows of print_changes().
std::string shown_change(const CovarianceRequest& request, std::size_t number);
/// Prints the correlation after each change, for each channel or tilt. change: name of the change,
/// such as a delay or a frequency shift; sizes: its values.
void print_changes(const CovarianceRequest& request, const char* change,
                   const std::vector<double>& sizes, const Estimate& correlation,
                   const char* what = "correlation");

}  // namespace flatspeckle::apps
