#pragma once

#include "grin/render/lights/light_disk.h"
#include "grin/render/lights/light_kind.h"

namespace flatspeckle::grin {

class FibreLightEnd;

/// The end of a fibre inside the stage or on its boundary. Light leaves each point of its disk in
/// directions d whose sine from the axis, times the index there, has the profile of `aperture` as
/// places have that of `radius` (RadialProfile, both even or both Gaussian). Even ones have the
/// same L/n^2 all over the disk and the cone, as a large fibre that is filled evenly; Gaussian ones
/// are a Gaussian beam at its waist, or a partially coherent one, as rays.
struct FibreLight {
  using End = FibreLightEnd;
  Vec3 centre, direction;
  double radius;
  double aperture;  ///< numerical
  double power = 1;
  Spread spread = Spread::even;
};

/// power times a chance per area and one per solid angle: cos(t) that of the sine's plane.
class FibreLightEnd {
 public:
  static constexpr bool is_point = true, is_beam = false;  // nothing hits it

  /// Throws InputError as LightDisk does, and for an aperture of more than the index.
  FibreLightEnd(const FibreLight& light, const Stage& stage, const IndexAt& index);

  double power() const { return power_; }
  double density(const Vec3& x) const { return disk_.density(x); }
  BoundaryPoint sample(RandomStream& random) const { return disk_.sample(random); }
  EndDirection sample_direction(const EndPosition& at, RandomStream& random) const;
  EndDirection towards(const EndPosition& at, const Vec3& direction) const;
  EmissionChange by_index(const EndPosition& at, const Vec3& direction) const;

 private:
  RadialProfile sines(const EndPosition& at) const { return {spread_, aperture_ / at.index, 1}; }
  EndDirection along(const EndPosition& at, const Vec3& direction, double cosine,
                     double density) const;

  LightDisk disk_;
  Spread spread_;
  double aperture_, power_;
};

struct FibreLightValues {
  using Light = FibreLight;
  std::vector<double> fibre_light{}, gaussian_fibre{};
};

void add_keys(Keys& keys, FibreLightValues& values);
std::vector<FibreLight> make_lights(const Keys& keys, const FibreLightValues& values);

}  // namespace flatspeckle::grin
