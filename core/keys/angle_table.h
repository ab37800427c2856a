#pragma once

#include <string>
#include <utility>
#include <vector>

namespace flatspeckle {

/// Function of an angle from 0 to pi, given by a table and interpolated linearly.
class AngleTable {
 public:
  /// Reads a CSV file with columns angle (radians, increasing from 0 to pi) and value (not
  /// negative, not all 0). Throws InputError; the message names the key.
  AngleTable(const std::string& key, const std::string& path);

  /// angles: increasing from 0 to pi.
  AngleTable(std::vector<double> angles, std::vector<double> values)
      : angles_(std::move(angles)), values_(std::move(values)) {}

  double operator()(double angle) const;
  const std::vector<double>& angles() const { return angles_; }
  const std::vector<double>& values() const { return values_; }
  /// Returns all angles and values as text that reads back as the same numbers.
  std::string text() const;

 private:
  std::vector<double> angles_, values_;
};

}  // namespace flatspeckle
