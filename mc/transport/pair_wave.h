#pragma once

#include <cmath>
#include <compare>
#include <numbers>

#include "flatland/scene/scene.h"

namespace flatspeckle::mc {

/// e_1 conj(e_2) of two far lights within a slab (C13), exp(top z + bottom (depth - z)); lengths in
/// mean free paths. A pair of views is that of the lights turned round.
struct PairWave {
  Complex top = 0, bottom = 0;
};

/// Directions of two lights, from above or below; none along the slab.
struct Pair {
  double first, second;
  auto operator<=>(const Pair&) const = default;
};

inline Pair turned_round(Pair pair) {
  return {pair.first + std::numbers::pi, pair.second + std::numbers::pi};
}

/// Of two lights by the cosines of their directions; k: per extinction coefficient.
inline PairWave pair_wave(double k, double first, double second) {
  PairWave wave;
  for (const double cosine : {first, second})
    (cosine > 0 ? wave.top : wave.bottom) -= 1 / (2 * std::abs(cosine));
  wave.top += Complex(0, k * (first - second));
  return wave;
}
inline PairWave pair_wave(const Scene& scene, Pair pair) {
  return pair_wave(scene.k / scene.medium.mu_t, std::cos(pair.first), std::cos(pair.second));
}

/// Transverse momentum of a pair (C35), per extinction coefficient.
inline double transverse_momentum(const Scene& scene, Pair pair) {
  return scene.k / scene.medium.mu_t * (std::sin(pair.first) - std::sin(pair.second));
}

}  // namespace flatspeckle::mc
