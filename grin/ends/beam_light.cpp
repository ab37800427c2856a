#include "grin/ends/beam_light.h"

#include <cmath>
#include <numbers>

namespace flatspeckle::grin {

using std::numbers::pi;

BeamLightEnd::BeamLightEnd(const BeamLight& light, const Stage& stage, const IndexAt&)
    : disk_(light.centre, unit_direction("beam_light, direction", light.direction), light.radius),
      power_(light.power),
      area_(pi * light.radius * light.radius) {
  constexpr int rim_points = 64;
  const Surface& boundary = stage.boundary;
  const double tolerance = 1e-9 * (light.radius + std::abs(distance(boundary, light.centre)));
  for (int i = 0; i < rim_points; ++i)
    if (!(distance(boundary, disk_.rim(2 * pi * i / rim_points)) <= tolerance))
      throw InputError("beam_light, radius", light.radius,
                       "the beam's disk must be inside the stage");
  if (distance(boundary, light.centre) >= -tolerance &&
      !(disk_.normal().dot(normal(boundary, light.centre)) < 0))
    throw InputError("beam_light, direction", listed(light.direction), "must point into the stage");
}

void add_keys(Keys& keys, BeamLightValues& values) {
  keys.add("beam_light", values.beam_light,
           "x y z dx dy dz radius power: parallel rays from an even disk")
      .each_of(8, "x y z dx dy dz radius power");
}

std::vector<BeamLight> make_lights(const Keys& keys, const BeamLightValues& values) {
  std::vector<BeamLight> lights;
  for (const auto b : parts_of(keys.read(values.beam_light), 8))
    lights.push_back({vector_of(b), unit_direction("beam_light, direction", vector_of(b, 3)),
                      positive("beam_light, radius", b[6]), positive("beam_light, power", b[7])});
  return lights;
}

}  // namespace flatspeckle::grin
