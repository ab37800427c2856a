#pragma once

#include "grin/render/lights/light_disk.h"
#include "grin/render/lights/light_kind.h"

namespace flatspeckle::grin {

class FibreLightEnd;

/// The end of a fibre inside the stage or on its boundary. Positions on its disk follow a
/// RadialProfile of radius `radius`; the index times the sine of the angle from the axis follows a
/// RadialProfile of radius `aperture`. Both profiles are uniform or both are Gaussian. Uniform
/// profiles give the same L/n^2 over disk and cone, as in a large, uniformly filled fibre. Gaussian
/// profiles represent a Gaussian beam at its waist, or a partially coherent beam.
struct FibreLight {
  using End = FibreLightEnd;
  Vec3 centre, direction;
  double radius;
  double aperture;  ///< numerical aperture
  double power = 1;
  Spread spread = Spread::even;
};

/// Path endpoint of a fibre. Its strength is the power times the density of positions per area
/// times the density of directions per solid angle. The density of directions is cos(t) times the
/// density in the plane of the sines of the angles; t is the angle from the axis.
class FibreLightEnd {
 public:
  static constexpr bool is_point = true, is_beam = false;  // no path hits it

  /// Throws InputError as LightDisk does, and for an aperture above the index of refraction.
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
