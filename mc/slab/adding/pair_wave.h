#pragma once

#include <cmath>
#include <numbers>
#include <type_traits>

#include <Eigen/Core>

#include "core/algebra/dual.h"

namespace flatspeckle::mc {

/// e_1 conj(e_2) of two far lights within a slab (C13), exp(top z + bottom (depth - z)); lengths in
/// mean free paths. A pair of views is that of the lights turned round.
template <typename Number>
struct PairWaveOf {
  ComplexOf<Number> top{}, bottom{};
};

/// Directions of two lights, from above or below, or of two views; none along the slab. Direction:
/// an angle in the plane, a unit vector in space (z into the slab).
template <typename Direction>
struct PairOf {
  Direction first, second;
  bool operator==(const PairOf&) const = default;
};
using Pair = PairOf<double>;
using SpacePair = PairOf<Eigen::Vector3d>;

inline double turned_round(double angle) {
  return angle + std::numbers::pi;
}
inline Eigen::Vector3d turned_round(const Eigen::Vector3d& direction) {
  return -direction;
}
template <typename Direction>
PairOf<Direction> turned_round(const PairOf<Direction>& pair) {
  return {turned_round(pair.first), turned_round(pair.second)};
}

inline double cosine_of(double angle) {
  return std::cos(angle);
}
inline double cosine_of(const Eigen::Vector3d& direction) {
  return direction.z();
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

/// k: per mu_t.
template <typename Number, typename Direction>
PairWaveOf<Number> pair_wave(double k, const PairOf<Direction>& pair,
                             const Departure<Number>& departure) {
  PairWaveOf<Number> wave;
  const double first = cosine_of(pair.first), second = cosine_of(pair.second);
  for (const double cosine : {first, second}) {
    auto& end = cosine > 0 ? wave.top : wave.bottom;
    end = end - 1 / (2 * std::abs(cosine));
  }
  const double along = first - (1 + departure.shift) * second;
  wave.top += Complex(0, k * along) * departure.length;
  return wave;
}

}  // namespace flatspeckle::mc
