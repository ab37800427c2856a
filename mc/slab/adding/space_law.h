#pragma once

#include <functional>
#include <vector>

namespace flatspeckle::mc {

/// A phase function in space, without chance: scalar amplitudes sqrt(p), and its Legendre moments,
///   p = sum_l (2 l + 1) / (4 pi) moments[l] P_l(cos).
/// Of fields at two times, between which the scatterers diffuse, the later one is the second of a
/// pair: each of its turns loses exp(-2 delay (1 - cos)) (brownian.h), and so does p.
class SpaceLaw {
 public:
  /// density: per steradian, by the cosine of the turn, in any unit.
  explicit SpaceLaw(std::function<double(double)> density, double delay = 0);

  /// A A' of two turns by their cosines.
  double pair(double first, double second) const {
    return amplitude(first) * amplitude(second) * decay(second);
  }
  /// Of Henyey-Greenstein's function without delay: d log pair / d g.
  double pair_slope(double g, double first, double second) const;
  /// Those above rounding; of a table with kinks the first 2048.
  const std::vector<double>& moments() const { return moments_; }
  /// The angle within which p changes.
  double width() const { return width_; }
  int least_order() const { return 0; }  ///< nodes of a panel

 private:
  double amplitude(double cosine) const;
  double decay(double cosine) const;

  std::function<double(double)> density_;
  std::vector<double> moments_;
  double total_, delay_, width_;
};

}  // namespace flatspeckle::mc
