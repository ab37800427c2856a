#include "grin/render/lights/beam_light.h"

namespace flatspeckle::grin {

namespace {

const char* beam_key(Spread spread) {
  return spread == Spread::even ? "beam_light" : "gaussian_beam";
}

BeamLight beam_of(std::span<const double> b, Spread spread) {
  const std::string key = beam_key(spread);
  return {vector_of(b), unit_direction(key + ", direction", vector_of(b, 3)),
          positive(key + ", radius", b[6]), positive(key + ", power", b[7]), spread};
}

}  // namespace

BeamLightEnd::BeamLightEnd(const BeamLight& light, const Stage& stage, const IndexAt&)
    : disk_(beam_key(light.spread), light.centre, light.direction,
            RadialProfile(light.spread, light.radius), stage),
      power_(light.power) {}

void add_keys(Keys& keys, BeamLightValues& values) {
  keys.add("beam_light", values.beam_light,
           "x y z dx dy dz radius power: parallel rays from a uniform disk")
      .each_of(8, "x y z dx dy dz radius power")
      .units("length length length 1 1 1 length 1");
  keys.add("gaussian_beam", values.gaussian_beam,
           "x y z dx dy dz radius power: parallel rays with a Gaussian profile of this 1/e^2 "
           "radius, cut off at three times the radius")
      .each_of(8, "x y z dx dy dz radius power")
      .units("length length length 1 1 1 length 1");
}

std::vector<BeamLight> make_lights(const Keys& keys, const BeamLightValues& values) {
  std::vector<BeamLight> lights;
  for (const auto b : parts_of(keys.read(values.beam_light), 8))
    lights.push_back(beam_of(b, Spread::even));
  for (const auto b : parts_of(keys.read(values.gaussian_beam), 8))
    lights.push_back(beam_of(b, Spread::gaussian));
  return lights;
}

}  // namespace flatspeckle::grin
