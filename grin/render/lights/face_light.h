#pragma once

#include "grin/render/lights/light_kind.h"

namespace flatspeckle::grin {

class FaceLightEnd;

/// The part of the boundary within `radius` of `centre`, Lambertian inwards: L/n^2 = radiance. An
/// infinite radius is the environment. Sphere and box boundaries only, see BoundaryPatch. Its power
/// is radiance pi times the integral of n^2 over the part.
struct FaceLight {
  using End = FaceLightEnd;
  Vec3 centre = Vec3::Zero();
  double radius;
  double radiance = 1;
};

class FaceLightEnd {
 public:
  static constexpr bool is_point = false, is_beam = false;

  FaceLightEnd(const FaceLight& light, const Stage& stage, const IndexAt& index);

  double power() const { return power_; }
  double density(const Vec3&) const { return 1 / patch_.area(); }
  BoundaryPoint sample(RandomStream& random) const { return patch_.sample(random); }
  EndDirection sample_direction(const EndPosition& at, RandomStream& random) const;
  EndDirection towards(const EndPosition& at, const Vec3& direction) const;
  EmissionChange by_index(const EndPosition&, const Vec3&) const { return {.weight = 2}; }
  bool contains(const Vec3& x) const { return patch_.contains(x); }
  Vec3 inward(const Vec3& x) const { return patch_.inward(x); }

 private:
  BoundaryPatch patch_;
  double radiance_, power_;
};

struct FaceLightValues {
  using Light = FaceLight;
  std::vector<double> face_light{};
  std::optional<double> environment = {};
};

void add_keys(Keys& keys, FaceLightValues& values);
/// The environment is the last.
std::vector<FaceLight> make_lights(const Keys& keys, const FaceLightValues& values);

}  // namespace flatspeckle::grin
