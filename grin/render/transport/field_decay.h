#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <vector>

#include "grin/media/geometry/vec3.h"

namespace flatspeckle::grin {

/// Momentum transfer of a path: the sum over its collisions of 1 - cos of the scattering angle, in
/// each part of the stage.
class MomentumTransfer {
 public:
  static constexpr std::size_t most_parts = 8;

  /// Adds a collision in a part, at which the path turns between two directions, unit vectors.
  void turned(int part, const Vec3& from, const Vec3& to) {
    by_part_[static_cast<std::size_t>(part)] += (to - from).squaredNorm() / 2;
  }
  double in(std::size_t part) const { return by_part_[part]; }

 private:
  std::array<double, most_parts> by_part_{};
};

/// Momentum transfer of light that is not scattered.
inline constexpr MomentumTransfer no_transfer{};

/// Decay of the field correlation while the scatterers diffuse. After a delay tau, a path with
/// momentum transfer Y contributes its power times exp(-2 k^2 D tau Y), Y being weighted by the
/// diffusion of each part (diffusing-wave spectroscopy: Pine et al. [pine1988]).
struct FieldDecay {
  std::vector<double> delays;     ///< k^2 D tau
  std::vector<double> diffusion;  ///< factor on D, by part

  std::size_t parts() const { return diffusion.size(); }
  double factor(std::size_t delay, const MomentumTransfer& transfer) const {
    double sum = 0;
    for (std::size_t part = 0; part < parts(); ++part) sum += diffusion[part] * transfer.in(part);
    return std::exp(-2 * delays[delay] * sum);
  }
};

}  // namespace flatspeckle::grin
