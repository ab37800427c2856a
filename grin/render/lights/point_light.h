#pragma once

#include <numbers>

#include "grin/media/scattering/start_directions.h"
#include "grin/render/lights/light_kind.h"
#include "grin/render/stage/regions.h"

namespace flatspeckle::grin {

class PointLightEnd;

/// Isotropic point light at x inside the stage.
struct PointLight {
  using End = PointLightEnd;
  Vec3 x;
  double power = 1;
};

class PointLightEnd {
 public:
  static constexpr bool is_point = true, is_beam = false;

  PointLightEnd(const PointLight& light, const Stage& stage, const IndexAt&) : light_(light) {
    if (!(distance(stage.boundary, light.x) < 0))
      throw InputError("point_light, position", listed(light.x), "must be inside the stage");
    require_in_stage(stage, "point_light, position", light.x);
  }

  double power() const { return light_.power; }
  double density(const Vec3&) const { return 1; }
  BoundaryPoint sample(RandomStream&) const { return {light_.x, Vec3::Zero()}; }
  EndDirection sample_direction(const EndPosition& at, RandomStream& random) const {
    return towards(at, random_turn(Vec3::UnitZ(), 2 * random.uniform(), random));
  }
  EndDirection towards(const EndPosition&, const Vec3& direction) const {
    constexpr double sphere = 4 * std::numbers::pi;
    return {.direction = direction, .density = 1 / sphere, .strength = light_.power / sphere};
  }
  EmissionChange by_index(const EndPosition&, const Vec3&) const { return {}; }

 private:
  PointLight light_;
};

struct PointLightValues {
  using Light = PointLight;
  std::vector<double> point_light{};
};

inline void add_keys(Keys& keys, PointLightValues& values) {
  keys.add("point_light", values.point_light, "x y z power: emits uniformly into all directions")
      .each_of(4, "x y z power")
      .units("length length length 1");
}

inline std::vector<PointLight> make_lights(const Keys& keys, const PointLightValues& values) {
  std::vector<PointLight> lights;
  for (const auto p : parts_of(keys.read(values.point_light), 4))
    lights.push_back({vector_of(p), positive("point_light, power", p[3])});
  return lights;
}

}  // namespace flatspeckle::grin
