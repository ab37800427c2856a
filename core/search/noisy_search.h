#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "core/numbers/statistics.h"

namespace flatspeckle {

/// The sums without each of `blocks` equal parts of their batches, or of as many as there are
/// groups; each with a group for each of the other blocks.
std::vector<GroupedSums> without_blocks(const GroupedSums& sums, std::size_t blocks);

/// A place in the unit cube.
using UnitPlace = std::vector<double>;

/// Looks for a maximum of `value` near `start` in the unit cube without derivatives (NLopt: BOBYQA
/// of Powell 2009, a quadratic model in a region of trust; of one number, the simplex of Nelder and
/// Mead). Steps begin with `first` and end with `last`. It ends early after `most` values, or where
/// there is none. What `value` throws is thrown again here.
void local_search(const UnitPlace& start, double first, double last, int most,
                  const std::function<std::optional<double>(const UnitPlace&)>& value);

/// A number that was measured with noise: its value, and what it is without each of the equal
/// blocks of its samples. Numbers that were measured with the same random numbers have blocks that
/// belong together, so that errors of their differences follow (jackknife). No blocks: no noise.
struct Measured {
  double value = 0;
  std::vector<double> without = {};
};

/// Standard error; 0 without noise.
double error(const Measured& one);

/// a - b with its standard error, which knows what is common to both: they have as many blocks, of
/// the same random numbers.
struct Difference {
  double value, error;

  /// In standard errors; without noise infinite, and 0 where there is no difference.
  double significance() const;
  /// How sure it is that a is greater: of a normal deviate, from 0 to 1.
  double confidence() const;
};
Difference difference(const Measured& a, const Measured& b);

/// a / b likewise.
Measured ratio(const Measured& a, const Measured& b);

/// Where a number is measured: numbers scaled to the unit cube, and one of some choices.
struct SearchPlace {
  UnitPlace at;
  std::size_t choice = 0;

  auto operator<=>(const SearchPlace&) const = default;
};

/// How often to measure, and with which random numbers: those of a draw are the same everywhere.
struct SearchEffort {
  double samples = 1;  ///< in units of the first measurements'
  std::uint64_t draw = 0;

  bool operator==(const SearchEffort&) const = default;
};

/// A noisy number to be made as large as can be.
struct SearchTask {
  std::size_t dimensions = 1, choices = 1;
  /// In the order of the places; the same number again where all is the same.
  std::function<std::vector<Measured>(const std::vector<SearchPlace>&, const SearchEffort&)>
      measure;
  bool negated = false;  ///< values are those of what is minimised, times -1
  /// How it gets on, in words.
  std::function<void(const std::string&)> tell = [](const std::string&) {};
};

struct SearchSettings {
  std::size_t scattered = 64;     ///< places to begin with, one of each choice at least
  std::size_t starts = 4;         ///< of these, so many of the best are searched around
  double tolerance = 1e-3;        ///< of a place, as a share of its range
  double target_error = 0.01;     ///< of the winner's value, relative
  double most_samples = 1 << 20;  ///< of a measurement, in units of the first
};

/// A place and what was measured there.
struct FoundPlace {
  SearchPlace place;
  Measured measured;
  double samples = 1;
};

/// What measure() throws where it has done enough: the search ends with what there is.
struct SearchSpent {};

/// Maxima, best first, each as good as could be told; behind them the best of the scattered places
/// away from these, if there are fewer than two. All by draw 0: their values are not to be
/// believed, for what is chosen for its value has luck in it. Measurements near a maximum grow
/// until differences show or are below the target error.
///
/// Scattered: the sequence of Roberts (2018), which fills a cube evenly in any dimension; over
/// all, and half as many again over a box around the best tenth of these, both also on the faces
/// that they come near.
struct SearchEnd {
  std::vector<FoundPlace> best;
  bool finished = true;
};
SearchEnd noisy_search(const SearchTask& task, const SearchSettings& settings);

/// Which of these is best, by random numbers of their own, and how good it is, by others again
/// (draws 1 and 2).
struct Winner {
  FoundPlace best, runner_up;
  Difference lead{};    ///< of the best over the runner-up
  bool reached = true;  ///< the target error
};
Winner chosen_winner(const SearchTask& task, const SearchSettings& settings,
                     const std::vector<FoundPlace>& found);

}  // namespace flatspeckle
