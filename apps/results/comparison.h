#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "core/numbers/statistics.h"

namespace flatspeckle::apps {

/// Monte Carlo held against a reference, value by value.
struct Comparison {
  std::string name;  ///< of the reference
  Estimate reference, mc;
  double bias = 0;            ///< of what differs without chance
  bool correlations = false;  ///< the bias is a share of 1, not of the value
  /// 1 where an entry is not to agree, for a reason that is known; empty: nowhere.
  std::vector<std::uint64_t> apart = {};

  /// Not below what rounding leaves.
  double error(std::size_t e) const;
  double difference(std::size_t e) const;
  /// In combined standard errors.
  double deviation(std::size_t e) const;
  std::vector<double> deviations() const;

  bool is_apart(std::size_t e) const { return !apart.empty() && apart[e] != 0; }
  bool within_errors(std::size_t e) const { return deviation(e) <= 4; }
  bool within_bias(std::size_t e) const { return difference(e) <= bias * scale(e); }
  /// What a bias is a share of.
  double scale(std::size_t e) const;

  /// Differences, combined errors and how many are within errors or bias, of all but those apart.
  /// Sizes are RMS, over the RMS of the reference. Nothing where all are apart.
  struct Whole {
    double difference, error, share_within;
  };
  std::optional<Whole> whole() const;
};

/// How the rows of a printed comparison begin.
struct RowNames {
  std::string head;
  std::function<std::string(std::size_t)> of;
};

/// How many values of the first so many are within errors, only within the bias, and apart.
struct Agreement {
  std::size_t in_errors = 0, in_bias = 0, apart = 0;
};
/// Prints the table of as many values.
Agreement print_comparison(const Comparison& comparison, std::size_t values, const RowNames& names);

}  // namespace flatspeckle::apps
