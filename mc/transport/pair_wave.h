#pragma once

#include <cmath>
#include <compare>
#include <numbers>
#include <type_traits>

#include "core/algebra/dual.h"
#include "flatland/scene/scene.h"

namespace flatspeckle::mc {

/// e_1 conj(e_2) of two far lights within a slab (C13), exp(top z + bottom (depth - z)); lengths in
/// mean free paths. A pair of views is that of the lights turned round.
template <typename Number>
struct PairWaveOf {
  ComplexOf<Number> top{}, bottom{};
};
using PairWave = PairWaveOf<double>;

/// Directions of two lights, from above or below; none along the slab.
struct Pair {
  double first, second;
  auto operator<=>(const Pair&) const = default;
};

inline Pair turned_round(Pair pair) {
  return {pair.first + std::numbers::pi, pair.second + std::numbers::pi};
}

/// How a calculation departs from the scene.
template <typename Number = double>
struct Departure {
  RealOf<Number> length{1};  ///< of a mean free path over the scene's: 1, and its derivative
  /// Of the wavenumber of the second field of each pair, relative; not 0 for Complex alone.
  double shift = 0;

  /// Per mu_t: radiance of pairs turns its phase along its way by the difference in wavenumber
  /// (C39). k: per mu_t.
  Number extinction(double k) const {
    if constexpr (std::is_same_v<Number, Complex>)
      return {1, shift * k};
    else
      return {1};
  }
};

/// Of two lights by the cosines of their directions; k: per mu_t.
template <typename Number>
PairWaveOf<Number> pair_wave(double k, double first, double second,
                             const Departure<Number>& departure) {
  PairWaveOf<Number> wave;
  for (const double cosine : {first, second}) {
    auto& end = cosine > 0 ? wave.top : wave.bottom;
    end = end - 1 / (2 * std::abs(cosine));
  }
  const double along = first - (1 + departure.shift) * second;
  wave.top += Complex(0, k * along) * departure.length;
  return wave;
}

template <typename Number>
PairWaveOf<Number> pair_wave(const Scene& scene, Pair pair, const Departure<Number>& departure) {
  return pair_wave(scene.k / scene.medium.mu_t, std::cos(pair.first), std::cos(pair.second),
                   departure);
}

/// Transverse momentum of a pair (C35), per extinction coefficient. shift: Departure's.
inline double transverse_momentum(const Scene& scene, Pair pair, double shift) {
  return scene.k / scene.medium.mu_t * (std::sin(pair.first) - (1 + shift) * std::sin(pair.second));
}

}  // namespace flatspeckle::mc
