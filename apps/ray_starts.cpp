#include "apps/ray_starts.h"

#include <cmath>
#include <map>
#include <numbers>
#include <set>

#include <Eigen/Geometry>

#include "apps/key_values.h"
#include "core/error.h"
#include "core/keys/csv.h"

namespace flatspeckle::apps {

namespace {

using grin::Vec3;

constexpr double golden_angle = std::numbers::pi * (3 - 2.23606797749978969641);

const std::map<std::string, std::set<std::string>> keys_of_light = {
    {"line", {"across", "beam_radius"}},
    {"disk", {"across", "beam_radius"}},
    {"beam", {"across", "beam_radius"}},
    {"fan", {"across", "half_angle"}},
    {"cone", {"across", "half_angle"}}};

std::string lights_with(const std::string& key) {
  std::string names;
  for (const auto& [light, keys] : keys_of_light)
    if (keys.contains(key)) names += ' ' + light;
  return names;
}

void check_keys(const Subcommand& command, const RayStartSpec& spec) {
  if (!keys_of_light.contains(spec.light))
    throw InputError("light", spec.light, "must be one of line disk beam fan cone");
  for (const char* key : {"across", "beam_radius", "half_angle"})
    if (command.given(key) && !keys_of_light.at(spec.light).contains(key))
      throw InputError(std::string(key) + ": the light (" + spec.light +
                       ") has no use for it; it is a key of" + lights_with(key));
  if (spec.ray_count < 1 || spec.ray_count > 100'000'000)
    throw InputError("ray_count", spec.ray_count, "must be from 1 to 100000000");
}

void refuse_light_keys(const Subcommand& command) {
  for (const char* key :
       {"light", "ray_count", "origin", "direction", "across", "beam_radius", "half_angle"})
    if (command.given(key))
      throw InputError(std::string(key) + ": the rays come from a file; leave it out");
}

std::vector<RayStart> read_rays(const std::string& path) {
  const Table table = read_csv(path);
  if (table.rows() == 0) throw InputError("rays", path, "holds no rays");
  const auto x = table.column("x"), y = table.column("y"), z = table.column("z");
  const auto dx = table.column("dx"), dy = table.column("dy"), dz = table.column("dz");
  std::vector<RayStart> starts;
  for (std::size_t i = 0; i < table.rows(); ++i)
    starts.push_back(
        {Vec3(x[i], y[i], z[i]),
         direction_of(path + ", direction of ray " + std::to_string(i), {dx[i], dy[i], dz[i]})});
  return starts;
}

/// The light's axis and two directions across it.
struct Axes {
  Vec3 along, first, second;
};

Axes axes_of(const RayStartSpec& spec) {
  const Vec3 along = direction_of("direction", spec.direction);
  const Vec3 given = direction_of("across", spec.across);
  const Vec3 across = given - along * along.dot(given);
  if (!(across.norm() > 1e-6))
    throw InputError("across", listed(spec.across), "must not be along the direction");
  const Vec3 first = across.normalized();
  return {along, first, along.cross(first)};
}

/// -1 to 1; of a single ray, 0.
double evenly(std::size_t i, std::size_t count) {
  return count > 1 ? 2.0 * static_cast<double>(i) / static_cast<double>(count - 1) - 1 : 0;
}
/// The part of a light's cross section within ray i: the middle of equal shares.
double share(std::size_t i, std::size_t count) {
  return (static_cast<double>(i) + 0.5) / static_cast<double>(count);
}

Vec3 around(const Axes& axes, std::size_t i) {
  const double azimuth = golden_angle * static_cast<double>(i);
  return std::cos(azimuth) * axes.first + std::sin(azimuth) * axes.second;
}

/// Ray i of a light of parallel rays: where it passes, from the origin, in beam radii.
Vec3 offset(const std::string& light, const Axes& axes, std::size_t i, std::size_t count) {
  if (light == "line") return evenly(i, count) * axes.first;
  const double part = share(i, count);
  // a Gaussian beam: intensity exp(-2 rho^2 / beam_radius^2)
  const double radius = light == "disk" ? std::sqrt(part) : std::sqrt(-std::log1p(-part) / 2);
  return radius * around(axes, i);
}

Vec3 turned(const RayStartSpec& spec, const Axes& axes, std::size_t i, std::size_t count) {
  if (spec.light == "fan") {
    const double angle = spec.half_angle * evenly(i, count);
    return std::cos(angle) * axes.along + std::sin(angle) * axes.first;
  }
  const double half = std::sin(spec.half_angle / 2);
  const double sine = half * std::sqrt(share(i, count));  // of half the angle: equal solid angles
  return (1 - 2 * sine * sine) * axes.along +
         2 * sine * std::sqrt(1 - sine * sine) * around(axes, i);
}

}  // namespace

void add_ray_start_options(Options& options, RayStartSpec& spec) {
  options.add("--rays", spec.rays, "CSV with columns x, y, z, dx, dy, dz, in place of a light");
  options.add(
      "--light", spec.light,
      "Parallel rays: line, disk (even), beam (Gaussian); from a point: fan, cone (default line)");
  options.add("--ray_count", spec.ray_count, "Rays of the light (default 11)");
  options.add("--origin", spec.origin, "x y z of the light's middle (default 0 0 0)");
  options.add("--direction", spec.direction, "Of its axis (default 0 0 1)");
  options.add("--across", spec.across, "Of the line, or of the fan's spread (default 1 0 0)");
  options.add("--beam_radius", spec.beam_radius,
              "Half the line, radius of the disk, 1/e^2 radius of the beam (default 1)");
  options.add("--half_angle", spec.half_angle, "Of fan and cone, radians (default 0.1)");
}

std::vector<RayStart> make_ray_starts(const Subcommand& command, const RayStartSpec& spec) {
  if (!spec.rays.empty()) {
    refuse_light_keys(command);
    return read_rays(spec.rays);
  }
  check_keys(command, spec);
  const Vec3 origin = vector_of("origin", spec.origin);
  const Axes axes = axes_of(spec);
  const bool from_a_point = spec.light == "fan" || spec.light == "cone";
  positive("beam_radius", spec.beam_radius);
  if (!(spec.half_angle > 0 && spec.half_angle <= std::numbers::pi))
    throw InputError("half_angle", spec.half_angle, "must be in (0, pi]");
  const auto count = static_cast<std::size_t>(spec.ray_count);
  std::vector<RayStart> starts;
  for (std::size_t i = 0; i < count; ++i)
    starts.push_back(
        from_a_point
            ? RayStart{origin, turned(spec, axes, i, count)}
            : RayStart{origin + spec.beam_radius * offset(spec.light, axes, i, count), axes.along});
  return starts;
}

}  // namespace flatspeckle::apps
