#pragma once

#include <type_traits>
#include <vector>

#include "core/algebra/dual.h"
#include "mc/space/space_law.h"

namespace flatspeckle::mc {

/// A law in space with its derivative: by what it does not know of, by g, or by the logarithm of
/// what its scatterers are.
class SpaceSlope {
 public:
  /// A law next to it, and its weight in a difference.
  struct Neighbour {
    double weight;
    SpaceLaw law;
  };

  explicit SpaceSlope(const SpaceLaw& law);
  SpaceSlope(const SpaceLaw& law, std::vector<Neighbour> neighbours);
  /// Of Henyey-Greenstein's function without delay, by g.
  static SpaceSlope by_g(const SpaceLaw& law, double g);

  Dual<double> pair(double first, double second) const;
  const Dual<std::vector<double>>& moments() const { return moments_; }
  double width() const { return law_.width(); }

 private:
  SpaceLaw law_;
  bool by_g_ = false;
  double g_ = 0;
  std::vector<Neighbour> neighbours_;
  Dual<std::vector<double>> moments_;
};

/// A law in space of calculations with a Number.
template <typename Number>
using SpaceLawOf = std::conditional_t<std::is_same_v<Number, Dual<double>>, SpaceSlope, SpaceLaw>;

}  // namespace flatspeckle::mc
