#include "grin/render/lights/face_light.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "grin/media/scattering/start_directions.h"

namespace flatspeckle::grin {

namespace {

using std::numbers::pi;

constexpr double everywhere = std::numeric_limits<double>::infinity();

BoundaryPatch patch_of(const FaceLight& light, const Surface& boundary) {
  if (light.radius == everywhere) return BoundaryPatch(boundary, "environment");
  return BoundaryPatch(boundary, light.centre, light.radius, "face_light, position",
                       "face_light, radius");
}

/// Returns the mean of n^2 over a patch, by Monte Carlo with 4096 points; exact for constant n.
double mean_index_squared(const BoundaryPatch& patch, const Regions& regions,
                          const IndexAt& index) {
  constexpr int points = 4096;
  RandomStream random(0, 0, 0);
  double mean = 0;
  for (int i = 0; i < points; ++i) {
    const Vec3 x = patch.sample(random).x;
    const double n = index({x, regions.at(x)});
    mean += (n * n - mean) / (i + 1);
  }
  if (!(mean > 0 && std::isfinite(mean)))
    throw InputError(
        "face_light: the index of refraction must be positive and finite everywhere on it");
  return mean;
}

}  // namespace

FaceLightEnd::FaceLightEnd(const FaceLight& light, const Stage& stage, const IndexAt& index)
    : patch_(patch_of(light, stage.boundary)),
      radiance_(light.radiance),
      power_(pi * mean_index_squared(patch_, Regions(stage), index) * patch_.area() *
             light.radiance),
      surrounds_(light.radius == everywhere) {}

EndDirection FaceLightEnd::sample_direction(const EndPosition& at, RandomStream& random) const {
  const double u = random.uniform(), cosine = std::sqrt(aim_ ? 1 - aim_->sample(1 - u) : u);
  return towards(at, random_turn(at.inward, 1 - cosine, random));
}

EndDirection FaceLightEnd::towards(const EndPosition& at, const Vec3& direction) const {
  const double cosine = std::max(0.0, direction.dot(at.inward));
  return {.direction = direction,
          .density = cosine / pi * (aim_ ? aim_->density(1 - cosine * cosine) : 1),
          .strength = at.index * at.index * cosine * radiance_};
}

void add_keys(Keys& keys, FaceLightValues& values) {
  keys.add("face_light", values.face_light,
           "x y z radius radiance: the stage's boundary within the radius of this point emits "
           "inwards with L/n^2 = radiance in all directions (Lambertian)")
      .each_of(5, "x y z radius radiance")
      .units("length length length length 1");
  keys.add("environment", values.environment,
           "L/n^2 of light that enters through the whole boundary")
      .positive();
}

std::vector<FaceLight> make_lights(const Keys& keys, const FaceLightValues& values) {
  std::vector<FaceLight> lights;
  for (const auto f : parts_of(keys.read(values.face_light), 5))
    lights.push_back({vector_of(f), positive("face_light, radius", f[3]),
                      positive("face_light, radiance", f[4])});
  if (const auto& radiance = keys.read(values.environment))
    lights.push_back({Vec3::Zero(), everywhere, *radiance});
  return lights;
}

}  // namespace flatspeckle::grin
