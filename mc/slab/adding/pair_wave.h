#pragma once

#include <algorithm>
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

/// Returns the mirror image of a direction in a face.
inline double mirrored(double angle) {
  return std::numbers::pi - angle;
}
inline Eigen::Vector3d mirrored(const Eigen::Vector3d& direction) {
  return {direction.x(), direction.y(), -direction.z()};
}
template <typename Direction>
PairOf<Direction> mirrored(const PairOf<Direction>& pair) {
  return {mirrored(pair.first), mirrored(pair.second)};
}

/// Returns a direction after refraction at a face, by which the sine of its angle from z changes by
/// the factor `ratio`. The new sine must be at most 1.
inline double refracted(double angle, double ratio) {
  if (ratio == 1) return angle;
  const double turned = std::asin(ratio * std::sin(angle));
  return std::cos(angle) > 0 ? turned : std::numbers::pi - turned;
}
inline Eigen::Vector3d refracted(const Eigen::Vector3d& direction, double ratio) {
  if (ratio == 1) return direction;
  const double x = ratio * direction.x(), y = ratio * direction.y();
  return {x, y, std::copysign(std::sqrt(std::max(0.0, 1 - x * x - y * y)), direction.z())};
}
template <typename Direction>
PairOf<Direction> refracted(const PairOf<Direction>& pair, double ratio) {
  return {refracted(pair.first, ratio), refracted(pair.second, ratio)};
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
