#pragma once

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <numbers>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/result/dataset_row.h"
#include "core/result/result_file.h"
#include "core/run/runner.h"
#include "flatland/request/request.h"

namespace flatspeckle::mc {

struct Refined;

/// Resolution of a solution.
struct Resolution {
  int order;  ///< nodes per panel of the angular grid
  int modes;  ///< highest mode of the azimuth, in space

  /// Returns the next larger order or mode.
  static int next(int number) { return (4 * number + 2) / 3; }
  Resolution finer_order() const { return {next(order), modes}; }
  Resolution finer_modes() const { return {order, next(modes)}; }
  bool operator==(const Resolution&) const = default;
};

/// Settings for the refinement of a deterministic solution. The number of ordinates is increased
/// until the solution agrees, within a relative tolerance, with the solution on a quarter fewer
/// ordinates.
struct Refinement {
  double tolerance = 1e-6;
  /// Largest number of ordinates, downward and upward together. If refinement ends because this
  /// number is reached, the error includes the remaining difference.
  int most_ordinates = 1500;
  /// If given, there is one solution with this resolution, whose errors are not estimated.
  std::optional<Resolution> fixed{};
  /// If given, the tolerance is divided by 4, at most four times, until this returns true.
  std::function<bool(const Refined&)> suffices{};

  /// Returns the number of nodes per panel of the first solution. For small tolerances fewer than 7
  /// have never been sufficient without faces, which cut panels into shorter ones.
  int first_order(bool has_faces) const { return tolerance > 1e-5 || has_faces ? 5 : 7; }
};

/// Changes of a value by the last three refinements, the most recent in `last`; infinite for
/// refinements that have not taken place.
struct Changes {
  double last = std::numeric_limits<double>::infinity(), before = last, first = last;

  void add(double change) { *this = {change, last, before}; }
  /// Whether there were at least two changes, because a single small one may be accidental.
  bool are_enough() const { return std::isfinite(before); }
  /// Returns an estimate of the remaining error: the last change or, if changes decay slowly, the
  /// sum of all further changes as a geometric series. It is at least the value that the two
  /// earlier changes predict for the last change.
  double error() const;
};

/// Values and their errors. An error is a complex number of the same unit as its value
/// (error_of()).
struct Refined {
  std::vector<Complex> value, error;
  int ordinates = 0;        ///< largest number of ordinates in any part of the solution
  Resolution resolution{};  ///< the highest of any part of the solution of a covariance

  void append(const Refined& other);
};

/// Factor that rotates the phase of an error by 120 degrees. If the errors of two values differ in
/// phase by 120 or 240 degrees, they do not cancel in the modulus or in the phase of the ratio of
/// the values.
constexpr Complex turn_of_errors(-0.5, std::numbers::sqrt3 / 2);

/// Returns an error of modulus `size`. For an intensity it has the phase of the value. For other
/// entries, which are later divided by intensities, its phase is rotated against that of the value
/// (turn_of_errors).
Complex error_of(const Entry& entry, Complex value, double size);

/// Function that returns the scale of each value of a solution: the magnitude to which the
/// tolerance of that value is relative.
using Scales = std::function<std::vector<double>(std::span<const Complex> values)>;

/// Returns the largest ratio of an error to its scale. Values with a scale of 0 are skipped.
double worst_error(const Refined& refined, const std::vector<double>& scales);

/// Returns the scale of each entry: its modulus or, if that is larger, the geometric mean of the
/// intensities of its two channels. If only one of the two intensities is among the entries, it is
/// used instead of the mean.
std::vector<double> scales(const std::vector<Entry>& entries, std::span<const Complex> values);

/// Returns the scales of the entries and, if derivatives follow the values, of the derivatives. The
/// scale of a derivative is the one that scales() returns for it or for its entry, whichever is
/// larger.
std::vector<double> scales_with_derivatives(const std::vector<Entry>& entries,
                                            std::span<const Complex> values);

/// Converts derivatives by the ratio parameter / unit to derivatives by the parameter. all: values,
/// followed by as many derivatives.
Refined by_parameter(Refined all, double unit);

/// Makes a job of two batches from a deterministic solution. The first batch contains the values
/// plus their errors, the second the values minus their errors. The batch statistics of any
/// function of the values then return its numerical error. `solve` is called when the first batch
/// runs. The relative error of the job is that of worst_error(); it exceeds the tolerance if the
/// refinement did not reach the tolerance.
BatchJob two_batches(std::size_t size, const std::function<Refined()>& solve, const Scales& scales);

extern const DatasetTable numerical_table;
/// Records in a result file, or in one of its groups, that the errors are numerical.
void write_numerical(ResultFile& file, const std::string& group = "");

}  // namespace flatspeckle::mc
