#include "apps/ray_connections.h"

#include <cmath>

#include "apps/key_values.h"
#include "core/error.h"
#include "grin/connection_solver.h"

namespace flatspeckle::apps {

namespace {

using grin::Vec3;

/// The side of each surface that both ends are on; points on a surface are on both.
class SameSides {
 public:
  SameSides(const SceneField& scene, const RayStops& stops, const Vec3& from, const Vec3& to)
      : surfaces_(stops.surfaces), location_(stops.location) {
    for (const auto& surface : surfaces_) signs_.push_back(common_side(surface, from, to));
    if (scene.rim) keep_inside(*scene.rim, from, to, "the ball");
    if (scene.grid) keep_inside(*scene.grid, from, to, "the grid");
  }

  bool operator()(const Vec3& x) const {
    for (std::size_t i = 0; i < surfaces_.size(); ++i)
      if (!(signs_[i] * distance(surfaces_[i], x) <= location_)) return false;
    return true;
  }

 private:
  /// 1: inside, -1: outside.
  double common_side(const grin::Surface& surface, const Vec3& from, const Vec3& to) const {
    const double a = distance(surface, from), b = distance(surface, to);
    if (a <= location_ && b <= location_) return 1;
    if (std::holds_alternative<grin::Plane>(surface))
      throw InputError("connect", listed(a > location_ ? from : to), "is behind a stop_plane");
    if (a >= -location_ && b >= -location_) return -1;
    throw InputError("connect", listed(from) + ' ' + listed(to),
                     "are on different sides of a stop surface");
  }

  void keep_inside(const grin::Surface& surface, const Vec3& from, const Vec3& to,
                   const std::string& what) {
    for (const Vec3& x : {from, to})
      if (distance(surface, x) > location_)
        throw InputError("connect", listed(x), "is outside of " + what);
    surfaces_.push_back(surface);
    signs_.push_back(1);
  }

  std::vector<grin::Surface> surfaces_;
  std::vector<double> signs_;
  double location_;
};

}  // namespace

void add_connect_options(CLI::App& app, ConnectSpec& spec) {
  app.add_option("--connect", spec.connect,
                 "x y z x y z: instead of rays, the curves from the first point to the second");
  app.add_option("--trials", spec.trials, "Random starts in search of curves (default 1000)");
}

FoundConnections find_connections(const SceneField& scene, const RayStops& stops, double step,
                                  const ConnectSpec& spec, std::uint64_t seed) {
  finite("connect", spec.connect);
  if (spec.connect.size() != 6)
    throw InputError("connect", listed(spec.connect), "must be six numbers x y z x y z");
  if (spec.trials < 1) throw InputError("trials", spec.trials, "must be positive");
  const Vec3 from(spec.connect[0], spec.connect[1], spec.connect[2]);
  const Vec3 to(spec.connect[3], spec.connect[4], spec.connect[5]);
  if ((to - from).norm() <= 1e-12 * std::max(from.norm(), to.norm()))
    throw InputError("connect", listed(spec.connect), "must be two different points");
  const SameSides region(scene, stops, from, to);
  const grin::ConnectionOptions options{.step = step, .max_length = stops.max_length};
  FoundConnections found;
  std::visit(
      [&](const auto& field) {
        for (const Vec3& x : {from, to})
          if (!(index(field, x) > 0))
            throw InputError("connect", listed(x), "is where the field has no index above 0");
        const grin::ConnectionTrial trial(field, region, from, to, options);
        RandomStream random(seed, static_cast<std::uint64_t>(Stream::light_paths), 0);
        found.curves = all_connections(trial, static_cast<std::uint64_t>(spec.trials), random,
                                       found.statistics);
      },
      scene.field);
  return found;
}

}  // namespace flatspeckle::apps
