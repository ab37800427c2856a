#include "grin/render/lights/face_light.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "core/frames/frames.h"
#include "core/keys/number_text.h"
#include "grin/media/scattering/start_directions.h"

namespace flatspeckle::grin {

namespace {

using std::numbers::pi;

/// Fraction of the directions of light from a map that are sampled in proportion to its radiance;
/// the others are Lambertian.
constexpr double from_map = 0.5;

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

/// Area of the projection of a convex boundary along a direction.
double projected_area(const Surface& boundary, const Vec3& direction) {
  if (const auto* sphere = std::get_if<Sphere>(&boundary))
    return pi * sphere->radius * sphere->radius;
  const auto& box = std::get<Box>(boundary);
  const Vec3 size = box.high - box.low;
  return std::abs(direction.x()) * size.y() * size.z() +
         std::abs(direction.y()) * size.z() * size.x() +
         std::abs(direction.z()) * size.x() * size.y();
}

/// Integral of radiance times the cosine over the area of a light and all directions inwards, for
/// n = 1.
double flux(const FaceLight& light, const BoundaryPatch& patch, const Surface& boundary) {
  if (!light.map) return pi * patch.area() * light.radiance;
  return light.radiance * light.map->integral([&](const Vec3& direction) {
    return projected_area(boundary, direction);
  });
}

Vec3 mirrored(const Vec3& direction, const Vec3& normal) {
  return direction - 2 * direction.dot(normal) * normal;
}

}  // namespace

FaceLightEnd::FaceLightEnd(const FaceLight& light, const Stage& stage, const IndexAt& index)
    : patch_(patch_of(light, stage.boundary)),
      radiance_(light.radiance),
      map_(light.map),
      power_(mean_index_squared(patch_, Regions(stage), index) *
             flux(light, patch_, stage.boundary)),
      surrounds_(light.radius == everywhere) {}

EndDirection FaceLightEnd::sample_direction(const EndPosition& at, RandomStream& random) const {
  if (map_ && random.uniform() < from_map) {
    const Vec3 sampled = -map_->sample(random);
    return towards(at, sampled.dot(at.inward) < 0 ? mirrored(sampled, at.inward) : sampled);
  }
  const double u = random.uniform(), cosine = std::sqrt(aim_ ? 1 - aim_->sample(1 - u) : u);
  return towards(at, random_turn(at.inward, 1 - cosine, random));
}

EndDirection FaceLightEnd::towards(const EndPosition& at, const Vec3& direction) const {
  const double cosine = std::max(0.0, direction.dot(at.inward));
  EndDirection to{.direction = direction,
                  .density = cosine / pi * (aim_ ? aim_->density(1 - cosine * cosine) : 1),
                  .strength = at.index * at.index * cosine * radiance_};
  if (map_ && cosine > 0) {
    const double sampled =
        map_->density(-direction) + map_->density(-mirrored(direction, at.inward));
    to.density += from_map * (sampled - to.density);
    to.strength *= map_->radiance(-direction);
  }
  return to;
}

namespace {

void add_direction(Keys& keys, const std::string& name, std::vector<double>& member,
                   const std::string& help) {
  keys.add(name, member, help).each_of(3, "x y z").only_of("environment_map");
}

/// Reads environment_map. Throws InputError.
std::shared_ptr<const EnvironmentMap> read_map(const Keys& keys, const FaceLightValues& values,
                                               const std::string& file) {
  const Frames read = read_frames("environment_map", file, {"", "picture"});
  if (read.count() != 1) throw InputError("environment_map", file, "must hold one picture");
  if (std::ranges::any_of(read.values, [](double value) { return value < 0; }) ||
      std::ranges::none_of(read.values, [](double value) { return value > 0; }))
    throw InputError("environment_map", file, "must have values from 0 on, and some above 0");
  const Vec3 centre = vector_of(keys.read(values.environment_centre)),
             up = vector_of(keys.read(values.environment_up));
  if (!(centre.cross(up).norm() > 1e-6 * centre.norm() * up.norm()))
    throw InputError("environment_up", number_text(values.environment_up),
                     "must be a direction that is not parallel to environment_centre");
  return std::make_shared<EnvironmentMap>(read.rows, read.columns, read.values, centre, up);
}

}  // namespace

void add_keys(Keys& keys, FaceLightValues& values) {
  keys.add("face_light", values.face_light,
           "x y z radius radiance: the stage's boundary within the radius of this point emits "
           "inwards with L/n^2 = radiance in all directions (Lambertian)")
      .each_of(5, "x y z radius radiance")
      .units("length length length length 1");
  keys.add("environment", values.environment,
           "L/n^2 of light that enters through the whole boundary")
      .positive();
  keys.add("environment_map", values.environment_map,
           "Picture of L/n^2 of the light that enters from each direction (PNG, TIFF, NPY, PFM, "
           "EXR, HDR or HDF5), multiplied by `environment`: rows are polar angles from "
           "environment_up, "
           "columns azimuths, to the right as seen from inside")
      .file();
  add_direction(keys, "environment_centre", values.environment_centre,
                "Direction of the middle of environment_map");
  add_direction(keys, "environment_up", values.environment_up,
                "Direction of the first row of environment_map");
}

std::vector<FaceLight> make_lights(const Keys& keys, const FaceLightValues& values) {
  std::vector<FaceLight> lights;
  for (const auto f : parts_of(keys.read(values.face_light), 5))
    lights.push_back({vector_of(f), positive("face_light, radius", f[3]),
                      positive("face_light, radiance", f[4])});
  const auto& radiance = keys.read(values.environment);
  if (const std::string& file = keys.read(values.environment_map); !file.empty())
    lights.push_back(
        {Vec3::Zero(), everywhere, radiance.value_or(1), read_map(keys, values, file)});
  else if (radiance)
    lights.push_back({Vec3::Zero(), everywhere, *radiance});
  return lights;
}

}  // namespace flatspeckle::grin
