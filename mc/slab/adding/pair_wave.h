#pragma once

#include <cmath>
#include <numbers>
#include <type_traits>

#include <Eigen/Core>

#include "core/algebra/dual.h"

namespace flatspeckle::mc {

/// Product e_1 conj(e_2) of the endpoint factors (C13) of two far illuminations at depth z in a
/// slab: exp(top z + bottom (depth - z)), with lengths in mean free paths. A pair of views is
/// represented by illuminations in the reversed directions.
template <typename Number>
struct PairWaveOf {
  ComplexOf<Number> top{}, bottom{};
};

/// Directions of two illuminations or of two views, not parallel to the faces. Direction: an angle
/// in the plane, or a unit vector in space, with z into the slab.
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

/// Difference between a calculation and its scene: the derivative of the mean free path by a
/// parameter, or a frequency shift of the second field.
template <typename Number = double>
struct Departure {
  /// Mean free path in units of the mean free path of the scene. The value is 1; Dual<double> adds
  /// its derivative.
  RealOf<Number> length{1};
  /// Relative shift of the wavenumber of the second field of each pair; 0 unless Number is Complex.
  double shift = 0;

  /// Returns the extinction coefficient in units of mu_t. Its imaginary part is the difference of
  /// the two wavenumbers, because the phase of the radiance of a field pair changes at this rate
  /// along a path (C39). k: wavenumber in units of mu_t.
  Number extinction(double k) const {
    if constexpr (std::is_same_v<Number, Complex>)
      return {1, shift * k};
    else
      return {1};
  }
};

/// Returns the product of the endpoint factors of two illuminations. k: wavenumber in units of
/// mu_t.
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
