#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "core/numbers/statistics.h"

namespace flatspeckle {

/// Divides the batches of the sums into `blocks` equal blocks (at most as many as there are
/// groups). Returns, for each block, the sums over all other blocks, with one group per block.
std::vector<GroupedSums> without_blocks(const GroupedSums& sums, std::size_t blocks);

/// Point in the unit cube of any dimension; each coordinate is a position between the bounds of a
/// variable.
using UnitPlace = std::vector<double>;

/// Maximises the function `value` near `start` in the unit cube without derivatives, by the
/// algorithms of NLopt: BOBYQA [powell2009], which uses a quadratic model in a trust region, or in
/// one dimension the simplex of Nelder and Mead [nelder1965]. The step size decreases from `first`
/// to `last`. Ends early after `most` evaluations or if `value` returns nullopt. Rethrows
/// exceptions of `value`.
void local_search(const UnitPlace& start, double first, double last, int most,
                  const std::function<std::optional<double>(const UnitPlace&)>& value);

/// A noisy measurement of a quantity. Its samples are divided into equal blocks, and without[i] is
/// the value computed from all blocks except block i, for the jackknife. If two measurements use
/// the same random numbers, so do their blocks of equal index; the error of their difference then
/// includes the correlation. If `without` is empty, the value has no noise.
struct Measured {
  double value = 0;
  std::vector<double> without = {};
};

/// Returns the standard error of a measurement; 0 if it has no noise.
double error(const Measured& one);

/// Difference a - b of two measurements with its standard error. The error includes the correlation
/// of a and b, which have the same number of blocks with the same random numbers.
struct Difference {
  double value, error;

  /// Returns value / error: 0 if the value is 0, and infinite for other values without noise.
  double significance() const;
  /// Returns the probability that a is greater than b, if the difference is normally distributed.
  double confidence() const;
};
Difference difference(const Measured& a, const Measured& b);

/// Returns the ratio a / b as a measurement, with a ratio for each block.
Measured ratio(const Measured& a, const Measured& b);

/// Point of the search at which the quantity is measured: continuous variables as a point in the
/// unit cube, and the index of a combination of discrete values (a choice).
struct SearchPlace {
  UnitPlace at;
  std::size_t choice = 0;

  auto operator<=>(const SearchPlace&) const = default;
};

/// Effort of a measurement: number of samples, and index of the set of random numbers (draw).
/// Measurements with the same draw use the same random numbers at all points.
struct SearchEffort {
  double samples = 1;  ///< in units of the number of samples of the first measurements
  std::uint64_t draw = 0;

  bool operator==(const SearchEffort&) const = default;
};

/// Maximisation of a noisy quantity: the size of the search space and the function that measures
/// the quantity.
struct SearchTask {
  std::size_t dimensions = 1, choices = 1;
  /// Measures the quantity at these points and returns the measurements in the same order. Equal
  /// arguments must give equal results.
  std::function<std::vector<Measured>(const std::vector<SearchPlace>&, const SearchEffort&)>
      measure;
  bool negated = false;  ///< true if the measured values are -1 times a quantity that is minimised
  /// Function that prints a text about the progress.
  std::function<void(const std::string&)> report = [](const std::string&) {};
};

struct SearchSettings {
  /// Number of points of the initial scan, at least one for each combination of discrete values.
  std::size_t scattered = 64;
  /// Number of the best points of the initial scan around which the search continues.
  std::size_t starts = 4;
  /// Tolerance of the coordinates of the maximum, as a fraction of the range of each variable.
  double tolerance = 1e-3;
  double target_error = 0.01;  ///< target for the relative error of the value at the best point
  /// Largest number of samples of a measurement, in units of the number of samples of the first
  /// measurements.
  double most_samples = 1 << 20;
};

/// A point of the search and the measurement there.
struct FoundPlace {
  SearchPlace place;
  Measured measured;
  double samples = 1;
};

/// Exception that SearchTask::measure() throws if its budget is spent; the search then ends with
/// the results so far.
struct SearchSpent {};

/// Maxima that a search has found, best first; maxima significantly below the best are left out. If
/// only one is left, the best point of the scan at some distance from it is added. All values come
/// from draw 0 and are biased upward, because the points were selected by value. The number of
/// samples of measurements near a maximum grows until differences between neighbouring points are
/// significant or below the target error.
///
/// The points of the initial scan follow the sequence of Roberts (2018), which fills a cube evenly
/// in any dimension. They fill the whole cube; then half as many points fill a box around the best
/// tenth of them. Both sets include points on faces of the cube.
struct SearchEnd {
  std::vector<FoundPlace> best;
  bool finished = true;
};
SearchEnd noisy_search(const SearchTask& task, const SearchSettings& settings);

/// The best of several points, selected by new measurements with draw 1, and the runner-up. Their
/// values, measured with draw 2, are independent of the selection and therefore unbiased.
struct Winner {
  FoundPlace best, runner_up;
  Difference lead{};    ///< value of the best minus value of the runner-up
  bool reached = true;  ///< whether the target error was reached
};
Winner chosen_winner(const SearchTask& task, const SearchSettings& settings,
                     const std::vector<FoundPlace>& found);

}  // namespace flatspeckle
