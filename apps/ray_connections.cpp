#include "apps/ray_connections.h"

#include <algorithm>
#include <cmath>

#include "apps/key_values.h"
#include "core/error.h"
#include "grin/connections/connection_solver.h"
#include "grin/rays/trace.h"

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

  /// Whether the curve meets no surface on its way, also between the steps that are asked about.
  template <grin::IndexField F>
  bool holds(const F& field, const Vec3& from, const grin::Connection& curve) const {
    grin::FixedSteps<grin::Sharma> steps{curve.sigma / curve.steps};
    grin::RayState ray = start_ray(field, from, curve.start_direction);
    trace(field, surfaces_, {curve.arc_length, location_}, steps, ray);
    return ray.arc_length > (1 - 1e-6) * curve.arc_length;  // its end may be on one
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

struct Ends {
  Vec3 from, to;
};

Ends ends_of(const ConnectSpec& spec) {
  const auto& x = finite("connect", spec.connect);
  if (x.size() != 6) throw InputError("connect", listed(x), "must be six numbers x y z x y z");
  const Ends ends{{x[0], x[1], x[2]}, {x[3], x[4], x[5]}};
  if ((ends.to - ends.from).norm() <= 1e-10 * std::max(ends.from.norm(), ends.to.norm()))
    throw InputError("connect", listed(x), "must be two different points");
  return ends;
}

/// Trials that ended on curves that do not hold have left the region.
template <class Holds>
void sort_out(FoundConnections& found, const Holds& holds) {
  auto& outcomes = found.statistics.outcomes;
  auto& converged = outcomes[static_cast<int>(grin::TrialOutcome::converged)];
  std::erase_if(found.curves, [&](const grin::FoundConnection& one) {
    if (holds(one.curve)) return false;
    const auto trials = std::min(converged, one.found);  // in a homogeneous field none ran
    converged -= trials;
    outcomes[static_cast<int>(grin::TrialOutcome::left_region)] += trials;
    return true;
  });
}

}  // namespace

double largest_index(const SceneField& scene, const ConnectSpec& spec) {
  const auto [from, to] = ends_of(spec);
  constexpr int points = 101;
  double largest = 0;
  for (int i = 0; i < points; ++i)
    largest = std::max(largest, index_at(scene, from + i / (points - 1.0) * (to - from)));
  return largest > 0 ? largest : 1;
}

void add_connect_options(Options& options, ConnectSpec& spec) {
  options.add("--connect", spec.connect,
              "x y z x y z: instead of rays, the curves from the first point to the second");
  options.add("--trials", spec.trials, "Random starts in search of curves (default 1000)");
}

FoundConnections find_connections(const SceneField& scene, const RayStops& stops, double step,
                                  const ConnectSpec& spec, std::uint64_t seed) {
  const Ends ends = ends_of(spec);
  if (spec.trials < 1) throw InputError("trials", spec.trials, "must be positive");
  const SameSides region(scene, stops, ends.from, ends.to);
  const grin::ConnectionOptions options{.step = step, .max_length = stops.max_length};
  FoundConnections found;
  std::visit(
      [&](const auto& field) {
        for (const Vec3& x : {ends.from, ends.to})
          if (!(index(field, x) > 0))
            throw InputError("connect", listed(x), "is where the field has no index above 0");
        const grin::ConnectionTrial trial(field, region, ends.from, ends.to, options);
        RandomStream random(seed, static_cast<std::uint64_t>(Stream::light_paths), 0);
        found.curves = all_connections(trial, static_cast<std::uint64_t>(spec.trials), random,
                                       found.statistics);
        sort_out(found, [&](const auto& curve) { return region.holds(field, ends.from, curve); });
      },
      scene.field);
  return found;
}

}  // namespace flatspeckle::apps
