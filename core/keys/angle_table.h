#pragma once

#include <string>
#include <vector>

namespace flatspeckle {

/// A function of an angle from 0 to pi, linear between its nodes.
class AngleTable {
 public:
  /// Of a CSV file with columns angle (radians, rising from 0 to pi) and value (not negative, not
  /// all 0). Throws InputError naming the key.
  AngleTable(const std::string& key, const std::string& path);

  double operator()(double angle) const;
  const std::vector<double>& angles() const { return angles_; }
  const std::vector<double>& values() const { return values_; }
  /// Every number, exactly.
  std::string text() const;

 private:
  std::vector<double> angles_, values_;
};

}  // namespace flatspeckle
