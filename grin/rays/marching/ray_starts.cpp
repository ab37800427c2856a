#include "grin/rays/marching/ray_starts.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <Eigen/Geometry>

#include "core/keys/csv.h"
#include "grin/media/geometry/vector_values.h"

namespace flatspeckle::grin {

namespace {

constexpr double golden_angle = std::numbers::pi * (3 - 2.23606797749978969641);

/// A light source of rays, with its axis and two directions perpendicular to the axis.
struct RayLight {
  Vec3 origin, along, first, second;
  double size;  ///< beam radius or half-angle, depending on the kind of light
  std::size_t count;

  /// Returns the coordinate of ray i if all rays are evenly spaced from -1 to 1; 0 for a single
  /// ray.
  double evenly(std::size_t i) const {
    return count > 1 ? 2.0 * static_cast<double>(i) / static_cast<double>(count - 1) - 1 : 0;
  }
  /// Returns the fraction of the cross section that is closer to the axis than ray i. The cross
  /// section is divided into equal parts, and each ray is in the middle of its part.
  double share(std::size_t i) const {
    return (static_cast<double>(i) + 0.5) / static_cast<double>(count);
  }
  Vec3 around(std::size_t i) const {
    const double azimuth = golden_angle * static_cast<double>(i);
    return std::cos(azimuth) * first + std::sin(azimuth) * second;
  }
  /// Returns a ray parallel to the axis, at a given offset from the axis in beam radii.
  RayStart parallel(const Vec3& offset) const { return {origin + size * offset, along}; }
};

RayStart line(const RayLight& light, std::size_t i) {
  return light.parallel(light.evenly(i) * light.first);
}
/// Returns ray i of a square beam. Uses the additive sequence of the plastic number [roberts2018],
/// which fills a square evenly.
RayStart square(const RayLight& light, std::size_t i) {
  constexpr double plastic = 1.32471795724474602596;  // x^3 = x + 1
  const auto place = [&](double share) {
    const double at = 0.5 + static_cast<double>(i) * share;
    return 2 * (at - std::floor(at)) - 1;
  };
  return light.parallel(place(1 / plastic) * light.first +
                        place(1 / (plastic * plastic)) * light.second);
}
RayStart disk(const RayLight& light, std::size_t i) {
  return light.parallel(std::sqrt(light.share(i)) * light.around(i));
}
/// Returns ray i of a Gaussian beam of intensity exp(-2 rho^2 / beam_radius^2) at the distance rho
/// from its axis.
RayStart beam(const RayLight& light, std::size_t i) {
  return light.parallel(std::sqrt(-std::log1p(-light.share(i)) / 2) * light.around(i));
}
RayStart fan(const RayLight& light, std::size_t i) {
  const double angle = light.size * light.evenly(i);
  return {light.origin, std::cos(angle) * light.along + std::sin(angle) * light.first};
}
/// Returns ray i of a cone of light, in which all rays represent equal solid angles.
RayStart cone(const RayLight& light, std::size_t i) {
  // Sine of half the angle between ray and axis
  const double sine = std::sin(light.size / 2) * std::sqrt(light.share(i));
  return {light.origin, (1 - 2 * sine * sine) * light.along +
                            2 * sine * std::sqrt(1 - sine * sine) * light.around(i)};
}

/// A kind of light source: its name in the key `light`, the member that contains its size, and the
/// function that returns its i-th ray.
struct LightKind {
  const char* word;
  double RayStartValues::*size;
  RayStart (*ray)(const RayLight&, std::size_t);
};
constexpr LightKind kinds[] = {
    {"line", &RayStartValues::beam_radius, line}, {"square", &RayStartValues::beam_radius, square},
    {"disk", &RayStartValues::beam_radius, disk}, {"beam", &RayStartValues::beam_radius, beam},
    {"fan", &RayStartValues::half_angle, fan},    {"cone", &RayStartValues::half_angle, cone}};

std::vector<std::string> words() {
  std::vector<std::string> words;
  for (const LightKind& kind : kinds) words.push_back(kind.word);
  return words;
}

std::vector<RayStart> read_rays(const std::string& path) {
  const Table table = read_key_table("rays", path, {"x", "y", "z", "dx", "dy", "dz"});
  const auto x = table.column("x"), y = table.column("y"), z = table.column("z");
  const auto dx = table.column("dx"), dy = table.column("dy"), dz = table.column("dz");
  std::vector<RayStart> starts;
  for (std::size_t i = 0; i < table.rows(); ++i)
    starts.push_back(
        {Vec3(x[i], y[i], z[i]), unit_direction(path + ", direction of ray " + std::to_string(i),
                                                Vec3(dx[i], dy[i], dz[i]))});
  return starts;
}

RayLight light_of(const Keys& keys, const RayStartValues& values, double size) {
  const Vec3 along = direction_of(keys, values.direction);
  const Vec3 given = direction_of(keys, values.across);
  const Vec3 across = given - along * along.dot(given);
  if (!(across.norm() > 1e-6))
    throw InputError("across", listed(vector_of(values.across)),
                     "must not be parallel to the direction");
  const Vec3 first = across.normalized();
  return {vector_of(keys.read(values.origin)),
          along,
          first,
          along.cross(first),
          size,
          static_cast<std::size_t>(keys.read(values.ray_count))};
}

}  // namespace

void add_keys(Keys& keys, RayStartValues& values) {
  keys.group("Rays");
  keys.add("rays", values.rays, "CSV with columns x, y, z, dx, dy, dz, instead of a light").file();
  keys.group("Rays", "a light of rays");
  keys.add("light", values.light,
           "line, square, disk: parallel rays, evenly distributed; beam: parallel rays of a "
           "Gaussian beam; fan, cone: rays from a point")
      .one_of(words());
  keys.add("ray_count", values.ray_count, "Number of rays of the light").from(1, 1e8);
  add_vector(keys, "origin", values.origin, "Centre of the light").unit("length");
  add_vector(keys, "direction", values.direction, "Direction of the light's axis, of any length");
  add_vector(keys, "across", values.across, "Direction along which the line or the fan extends");
  keys.add("beam_radius", values.beam_radius,
           "Half-length of the line, half-side of the square, radius of the disk, 1/e^2 radius of "
           "the beam")
      .positive()
      .unit("length")
      .only_of("line, square, disk, beam");
  keys.add("half_angle", values.half_angle, "Half-angle of fan or cone")
      .positive_to(std::numbers::pi)
      .unit("rad")
      .only_of("fan, cone");
}

std::vector<RayStart> make_ray_starts(const Keys& keys, const RayStartValues& values) {
  if (!keys.read(values.rays).empty()) return read_rays(values.rays);
  const LightKind& kind = *std::find_if(std::begin(kinds), std::end(kinds), [&](const auto& one) {
    return keys.read(values.light) == one.word;
  });
  const RayLight light = light_of(keys, values, keys.read(values.*kind.size));
  std::vector<RayStart> starts;
  for (std::size_t i = 0; i < light.count; ++i) starts.push_back(kind.ray(light, i));
  return starts;
}

}  // namespace flatspeckle::grin
