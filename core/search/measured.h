#pragma once

#include <vector>

namespace flatspeckle {

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

}  // namespace flatspeckle
