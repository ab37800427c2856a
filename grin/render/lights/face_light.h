#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "grin/render/lights/aim.h"
#include "grin/render/lights/environment_map.h"
#include "grin/render/lights/light_kind.h"

namespace flatspeckle::grin {

class FaceLightEnd;

/// A light on the part of the boundary within `radius` of `centre`. It is Lambertian: it emits
/// inwards with the same L/n^2, `radiance`, in all directions. An infinite radius is the whole
/// boundary (environment); its radiance may be multiplied by a map of directions. Requires a sphere
/// or a box as boundary (BoundaryPatch). Without a map its power is pi times `radiance` times the
/// integral of n^2 over the emitting area.
struct FaceLight {
  using End = FaceLightEnd;
  Vec3 centre = Vec3::Zero();
  double radius;
  double radiance = 1;
  std::shared_ptr<const EnvironmentMap> map = nullptr;
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
  bool surrounds() const { return surrounds_; }
  Vec3 inward(const Vec3& x) const { return patch_.inward(x); }
  /// Samples directions by this aim instead of the Lambertian density.
  void aim(const Aim& at) { aim_ = at; }

 private:
  BoundaryPatch patch_;
  double radiance_;
  std::shared_ptr<const EnvironmentMap> map_;
  double power_;
  bool surrounds_;
  std::optional<Aim> aim_ = {};
};

struct FaceLightValues {
  using Light = FaceLight;
  std::vector<double> face_light{};
  std::optional<double> environment = {};
  std::string environment_map{};
  std::vector<double> environment_centre{0, 0, 1}, environment_up{0, 1, 0};
};

void add_keys(Keys& keys, FaceLightValues& values);
/// Makes the lights of these keys; the light of `environment` is the last.
std::vector<FaceLight> make_lights(const Keys& keys, const FaceLightValues& values);

}  // namespace flatspeckle::grin
