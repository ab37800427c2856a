#pragma once

#include <functional>
#include <vector>

namespace flatspeckle::mc {

/// A phase function in space, without chance: scalar amplitudes sqrt(p), and its Legendre moments,
///   p = sum_l (2 l + 1) / (4 pi) moments[l] P_l(cos).
class SpaceLaw {
 public:
  /// density: per steradian, by the cosine of the turn, in any unit.
  explicit SpaceLaw(std::function<double(double)> density);

  double amplitude(double cosine) const;
  /// Those above rounding; of a table with kinks the first 2048.
  const std::vector<double>& moments() const { return moments_; }
  /// The angle within which p changes.
  double width() const { return width_; }

 private:
  std::function<double(double)> density_;
  std::vector<double> moments_;
  double total_, width_;
};

}  // namespace flatspeckle::mc
