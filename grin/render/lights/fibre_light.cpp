#include "grin/render/lights/fibre_light.h"

#include <cmath>

#include "grin/media/scattering/start_directions.h"

namespace flatspeckle::grin {

namespace {

const char* fibre_key(Spread spread) {
  return spread == Spread::even ? "fibre_light" : "gaussian_fibre";
}

FibreLight fibre_of(std::span<const double> f, Spread spread) {
  const std::string key = fibre_key(spread);
  return {vector_of(f),
          unit_direction(key + ", direction", vector_of(f, 3)),
          positive(key + ", radius", f[6]),
          positive(key + ", aperture", f[7]),
          positive(key + ", power", f[8]),
          spread};
}

}  // namespace

FibreLightEnd::FibreLightEnd(const FibreLight& light, const Stage& stage, const IndexAt& index)
    : disk_(fibre_key(light.spread), light.centre, light.direction,
            RadialProfile(light.spread, light.radius), stage),
      spread_(light.spread),
      aperture_(light.aperture),
      power_(light.power) {
  const double there = index({light.centre, Regions(stage).at(light.centre)});
  if (!(light.aperture <= there))
    throw InputError(std::string(fibre_key(spread_)) + ", aperture", light.aperture,
                     "must be at most the index of refraction at the fibre");
}

EndDirection FibreLightEnd::sample_direction(const EndPosition& at, RandomStream& random) const {
  const RadialProfile profile = sines(at);
  const double square = profile.square(random.uniform()), cosine = std::sqrt(1 - square);
  return along(at, random_turn(at.inward, square / (1 + cosine), random), cosine,
               profile.density(square));
}

EndDirection FibreLightEnd::towards(const EndPosition& at, const Vec3& direction) const {
  const RadialProfile profile = sines(at);
  const double cosine = direction.dot(at.inward), square = 1 - cosine * cosine;
  if (!(cosine > 0 && profile.contains(square))) return {.direction = direction};
  return along(at, direction, cosine, profile.density(square));
}

/// The sine of the angle of emitted light from the fibre's axis is proportional to 1/n.
EmissionChange FibreLightEnd::by_index(const EndPosition& at, const Vec3& direction) const {
  return {.direction = at.inward / direction.dot(at.inward) - direction};
}

EndDirection FibreLightEnd::along(const EndPosition& at, const Vec3& direction, double cosine,
                                  double density) const {
  return {.direction = direction,
          .density = cosine * density,
          .strength = power_ * disk_.density(at.point.x) * cosine * density};
}

void add_keys(Keys& keys, FibreLightValues& values) {
  const char* const numbers = "x y z dx dy dz radius aperture power";
  keys.add("fibre_light", values.fibre_light,
           "x y z dx dy dz radius aperture power: a uniform disk with the same L/n^2 in all "
           "directions within the numerical aperture")
      .each_of(9, numbers)
      .units("length length length 1 1 1 length 1 1");
  keys.add("gaussian_fibre", values.gaussian_fibre,
           "x y z dx dy dz radius aperture power: Gaussian profiles of position and direction with "
           "this 1/e^2 radius and aperture, both cut off at three times these values")
      .each_of(9, numbers)
      .units("length length length 1 1 1 length 1 1");
}

std::vector<FibreLight> make_lights(const Keys& keys, const FibreLightValues& values) {
  std::vector<FibreLight> lights;
  for (const auto f : parts_of(keys.read(values.fibre_light), 9))
    lights.push_back(fibre_of(f, Spread::even));
  for (const auto f : parts_of(keys.read(values.gaussian_fibre), 9))
    lights.push_back(fibre_of(f, Spread::gaussian));
  return lights;
}

}  // namespace flatspeckle::grin
