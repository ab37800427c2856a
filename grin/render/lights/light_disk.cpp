#include "grin/render/lights/light_disk.h"

#include <cmath>
#include <numbers>

#include "core/error.h"
#include "core/keys/number_text.h"
#include "grin/media/geometry/vector_values.h"

namespace flatspeckle::grin {

using std::numbers::pi;

LightDisk::LightDisk(const char* light, const Vec3& centre, const Vec3& direction,
                     const RadialProfile& profile, const Stage& stage)
    : disk_(centre, unit_direction(std::string(light) + ", direction", direction), profile.rim()),
      profile_(profile) {
  constexpr int rim_points = 64;
  const Surface& boundary = stage.boundary;
  const double tolerance = 1e-9 * (profile.rim() + std::abs(distance(boundary, centre)));
  const auto key = [&](const char* of) { return std::string(light) + ", " + of; };
  for (int i = 0; i < rim_points; ++i)
    if (!(distance(boundary, disk_.polar(profile.rim(), 2 * pi * i / rim_points)) <= tolerance))
      throw InputError(
          key("radius"), profile.radius(),
          "the light, a disk of radius " + number_text(profile.rim()) +
              " perpendicular to its direction, must be inside the stage; move it inwards if it "
              "is tilted against the boundary");
  if (distance(boundary, centre) >= -tolerance && !(axis().dot(normal(boundary, centre)) < 0))
    throw InputError(key("direction"), listed(direction), "must point into the stage");
}

BoundaryPoint LightDisk::sample(RandomStream& random) const {
  if (profile_.is_even()) return {disk_.sample(random), axis()};
  const double u = random.uniform();
  return from_square(u, random.uniform());
}

BoundaryPoint LightDisk::from_square(double u, double v) const {
  return {disk_.polar(std::sqrt(profile_.square(u)), 2 * pi * v), axis()};
}

}  // namespace flatspeckle::grin
