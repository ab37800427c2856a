#pragma once

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <numbers>
#include <span>
#include <string>
#include <vector>

#include "core/result/dataset_row.h"
#include "core/result/result_file.h"
#include "core/run/runner.h"
#include "flatland/request/request.h"

namespace flatspeckle::mc {

/// How far a solution without chance is refined: until it agrees with that of a quarter fewer
/// ordinates to a relative tolerance.
struct Refinement {
  double tolerance = 1e-6;
  int least_order = 5;  ///< nodes of a panel
  /// Of both ways; the error tells what is missing. 0: one solution, in space one step.
  int most_ordinates = 1500;

  /// Where small tolerances are asked for, fewer nodes have never been enough.
  int first_order() const { return std::max(least_order, tolerance > 1e-5 ? 5 : 7); }
  static int next_order(int order) { return (4 * order + 2) / 3; }
};

/// Holds what the last refinements have changed a value by, infinite where there were not so many.
struct Changes {
  double last = std::numeric_limits<double>::infinity(), before = last, first = last;

  void add(double change) { *this = {change, last, before}; }
  /// One small change may be chance: two at the least are needed.
  bool are_enough() const { return std::isfinite(before); }
  /// The error that is left: all further changes of a geometric series, where they decay slowly,
  /// and as much as the changes before the last promise of it.
  double error() const;
};

/// Values and their errors, each as a number that is added to its value.
struct Refined {
  std::vector<Complex> value, error;
  int ordinates = 0;  ///< the most that any part has needed

  void append(const Refined& other);
};

/// Turns errors by 120 degrees: those of two values that are divided do not cancel then, in the
/// modulus and in the phase, also where one of them is turned twice.
constexpr Complex turn_of_errors(-0.5, std::numbers::sqrt3 / 2);

/// An error of this size: of an intensity along it, of what is divided by intensities turned.
Complex error_of(const Entry& entry, Complex value, double size);

/// What the tolerance of each value is relative to, where values are those of one solution.
using Scales = std::function<std::vector<double>(std::span<const Complex> values)>;

/// The largest error over its scale; 0 where a scale is 0.
double worst_error(const Refined& refined, const std::vector<double>& scales);

/// What the tolerance of each entry is relative to: its value, or the root of its two intensities
/// (or that which there is) where that is more.
std::vector<double> scales(const std::vector<Entry>& entries, std::span<const Complex> values);

/// The same of values per entry that may be followed by derivatives, which are as the entry or the
/// derivative, whichever is more.
std::vector<double> scales_with_slopes(const std::vector<Entry>& entries,
                                       std::span<const Complex> values);

/// Values, then derivatives by parameter/unit: those by the parameter.
Refined by_parameter(Refined all, double unit);

/// A solution as a job of two batches, the values plus and minus their errors: what the
/// statistics of batches call the standard error of any function of them is its error then.
/// Solved when the first batch runs. The relative error of the job is the worst of any value, which
/// is more than the tolerance where that is not reached.
BatchJob two_batches(std::size_t size, const std::function<Refined()>& solve, const Scales& scales);

extern const DatasetTable numerical_table;
/// Says of a result, or of a group of it, that its errors are such.
void write_numerical(ResultFile& file, const std::string& group = "");

}  // namespace flatspeckle::mc
