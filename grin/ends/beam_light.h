#pragma once

#include "grin/ends/light_kind.h"

namespace flatspeckle::grin {

class BeamLightEnd;

/// Parallel rays, uniform over a disk inside the stage or on its boundary.
struct BeamLight {
  using End = BeamLightEnd;
  Vec3 centre, direction;
  double radius;
  double power = 1;
};

class BeamLightEnd {
 public:
  static constexpr bool is_point = false, is_beam = true;

  /// Throws InputError for a disk that reaches out of the stage, or light that leaves it at once.
  BeamLightEnd(const BeamLight& light, const Stage& stage, const IndexAt&);

  double power() const { return power_; }
  double area() const { return area_; }
  const FlatDisk& disk() const { return disk_; }
  BoundaryPoint sample(RandomStream& random) const {
    return {disk_.sample(random), disk_.normal()};
  }
  EndDirection sample_direction(const EndPosition& at, RandomStream&) const {
    return {.direction = at.inward, .density = 1, .strength = power_ * at.position_density};
  }
  /// Only its own direction, and that by chance never.
  EndDirection towards(const EndPosition&, const Vec3& direction) const {
    return {.direction = direction};
  }

 private:
  FlatDisk disk_;
  double power_, area_;
};

struct BeamLightValues {
  using Light = BeamLight;
  std::vector<double> beam_light{};
};

void add_keys(Keys& keys, BeamLightValues& values);
std::vector<BeamLight> make_lights(const Keys& keys, const BeamLightValues& values);

}  // namespace flatspeckle::grin
