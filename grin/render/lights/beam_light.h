#pragma once

#include "grin/render/lights/light_disk.h"
#include "grin/render/lights/light_kind.h"

namespace flatspeckle::grin {

class BeamLightEnd;

/// Parallel rays from a disk inside the stage or on its boundary, with uniform irradiance, or
/// Gaussian irradiance with 1/e^2 radius `radius` (RadialProfile).
struct BeamLight {
  using End = BeamLightEnd;
  Vec3 centre, direction;
  double radius;
  double power = 1;
  Spread spread = Spread::even;
};

class BeamLightEnd {
 public:
  static constexpr bool is_point = false, is_beam = true;

  /// Throws InputError for a disk that extends beyond the stage or emits out of it.
  BeamLightEnd(const BeamLight& light, const Stage& stage, const IndexAt&);

  double power() const { return power_; }
  const LightDisk& disk() const { return disk_; }
  double density(const Vec3& x) const { return disk_.density(x); }
  BoundaryPoint sample(RandomStream& random) const { return disk_.sample(random); }
  EndDirection sample_direction(const EndPosition& at, RandomStream&) const {
    return {.direction = at.inward, .density = 1, .strength = power_ * at.position_density};
  }
  /// Returns strength 0: a given direction equals the direction of the beam with probability 0.
  EndDirection towards(const EndPosition&, const Vec3& direction) const {
    return {.direction = direction};
  }
  EmissionChange by_index(const EndPosition&, const Vec3&) const { return {}; }

 private:
  LightDisk disk_;
  double power_;
};

struct BeamLightValues {
  using Light = BeamLight;
  std::vector<double> beam_light{}, gaussian_beam{};
};

void add_keys(Keys& keys, BeamLightValues& values);
std::vector<BeamLight> make_lights(const Keys& keys, const BeamLightValues& values);

}  // namespace flatspeckle::grin
