#include "apps/ray_tracing.h"

#include <algorithm>
#include <cmath>

#include "apps/key_values.h"
#include "apps/ray_path.h"
#include "core/error.h"
#include "core/run/parallel.h"
#include "grin/rays/trace.h"

namespace flatspeckle::apps {

namespace {

using grin::IndexField;
using grin::RayState;
using grin::Vec3;

std::string name(std::size_t ray) {
  return "ray " + std::to_string(ray);
}

void check_start(const SceneField& scene, const RayStops& stops, std::size_t number,
                 const RayStart& start) {
  const auto refuse = [&](const std::string& where) {
    throw InputError(name(number) + " starts at " + listed(start.x) + ": " + where);
  };
  if (scene.grid && scene.grid->distance(start.x) > 0) refuse("outside of the grid");
  if (!(index_at(scene, start.x) > 0)) refuse("the field has no index above 0 there");
  for (const auto& surface : stops.surfaces)
    if (const auto* plane = std::get_if<grin::Plane>(&surface);
        plane && plane->distance(start.x) > stops.location)
      refuse("behind stop_plane = " + listed(plane->point) + ' ' + listed(plane->outwards));
}

/// Steps, and what is to be known of them on the way.
template <class Steps>
struct WatchedSteps {
  Steps steps;
  bool keeps_path;
  double index_mismatch = 0;
  RayPath path = {};

  template <IndexField F, class Ray>
  static void step(const F& field, double h, Ray& ray) {
    Steps::step(field, h, ray);
  }
  template <IndexField F, class Ray>
  double advance(const F& field, Ray& ray) {
    const double h = steps.advance(field, ray);
    look(field, ray);
    if (keeps_path) path.add(ray);
    return h;
  }
  template <IndexField F>
  void look(const F& field, const RayState& ray) {
    // NaN, beyond the last index, is not kept
    index_mismatch = std::max(index_mismatch, std::abs(ray.v.norm() - index(field, ray.x)));
  }
};

template <IndexField F, class Steps>
class Tracer {
 public:
  Tracer(const F& field, const SceneField& scene, const RayStops& stops, const Steps& steps,
         std::size_t path_points)
      : field_(field), scene_(scene), stops_(stops), steps_(steps), path_points_(path_points) {
    surfaces_ = stops.surfaces;
    if (scene.grid) surfaces_.push_back(*scene.grid);
    if (scene.rim) surfaces_.push_back(*scene.rim);
  }

  TracedRay trace(std::size_t number, const RayStart& start) const {
    WatchedSteps<Steps> steps{steps_, path_points_ > 0};
    const double n = index_at(scene_, start.x);
    RayState ray{start.x, n * start.direction};
    if (steps.keeps_path) steps.path.add(ray);
    TracedRay traced{.first = invariants(ray)};
    const grin::TraceEnd end = follow(number, steps, ray, traced.steps);
    traced.end = ray;
    traced.last = invariants(ray);
    traced.index_mismatch = steps.index_mismatch;
    traced.status = end.stop == grin::Stop::length     ? RayStatus::length
                    : end.surface < numbers_of_stops() ? RayStatus::surface
                                                       : RayStatus::edge_of_grid;
    const bool is_stop = traced.status == RayStatus::surface;
    traced.surface = static_cast<std::uint64_t>(is_stop ? end.surface : numbers_of_stops());
    if (path_points_ > 0) traced.path = steps.path.points(path_points_);
    return traced;
  }

 private:
  int numbers_of_stops() const { return static_cast<int>(stops_.surfaces.size()); }
  grin::RayInvariants invariants(const RayState& ray) const {
    return ray_invariants(field_, ray, scene_.centre, scene_.axis);
  }

  /// From rim to rim, until the ray ends.
  grin::TraceEnd follow(std::size_t number, WatchedSteps<Steps>& steps, RayState& ray,
                        std::uint64_t& made) const {
    constexpr int most_rims = 100'000;
    if (leaves_grid(ray)) return {.stop = grin::Stop::surface, .surface = numbers_of_stops()};
    for (int i = 0; i < most_rims; ++i) {
      const auto go = [&](const auto& field) { return segment(field, steps, ray); };
      const grin::TraceEnd end = is_outside(ray) ? std::visit(go, scene_.outside) : go(field_);
      made += static_cast<std::uint64_t>(end.steps);
      if (end.stop == grin::Stop::lost) throw lost(number, end, ray);
      const bool at_rim = scene_.rim && end.surface + 1 == static_cast<int>(surfaces_.size());
      if (end.stop == grin::Stop::length || !at_rim) return end;
    }
    throw InputError("max_length", stops_.max_length, name(number) + " meets the rim too often");
  }

  template <IndexField Segment>
  grin::TraceEnd segment(const Segment& field, WatchedSteps<Steps>& steps, RayState& ray) const {
    const grin::TraceLimits limits{stops_.max_length - ray.arc_length, stops_.location};
    const auto end = grin::trace(field, surfaces_, limits, steps, ray);
    if (steps.keeps_path) steps.path.end_with(ray);
    steps.look(field, ray);
    return end;
  }

  /// From its edge.
  bool leaves_grid(const RayState& ray) const {
    return scene_.grid && scene_.grid->distance(ray.x) >= -stops_.location &&
           ray.v.dot(scene_.grid->normal(ray.x)) >= 0;
  }

  bool is_outside(const RayState& ray) const {
    if (!scene_.rim) return false;
    const double distance = scene_.rim->distance(ray.x);
    if (std::abs(distance) > stops_.location) return distance > 0;
    return ray.v.dot(scene_.rim->normal(ray.x)) >= 0;
  }

  InputError lost(std::size_t number, const grin::TraceEnd& end, const RayState& ray) const {
    constexpr long most_steps = grin::TraceLimits{}.max_steps;
    if (end.steps >= most_steps)
      return InputError("max_length", stops_.max_length,
                        name(number) + " takes more than " + std::to_string(most_steps) +
                            " steps; they may be longer");
    const std::string where = ray.x.allFinite() ? ", near " + listed(ray.x) : "";
    return InputError(
        name(number) +
        " comes to where the index is not above 0, or changes too fast for the tolerance" + where);
  }

  const F& field_;
  const SceneField& scene_;
  const RayStops& stops_;
  const Steps& steps_;
  std::size_t path_points_;
  std::vector<grin::Surface> surfaces_;
};

template <class Integrator, IndexField F, class Use>
void with_steps(const F&, const RaySteps& steps, const Use& use) {
  if (steps.tolerance)
    use(grin::ControlledSteps<Integrator>{*steps.tolerance, steps.longest / 16, steps.longest});
  else
    use(grin::FixedSteps<Integrator>{steps.longest});
}

}  // namespace

std::vector<TracedRay> trace_rays(const SceneField& scene, const RayStops& stops,
                                  const RaySteps& steps, const std::vector<RayStart>& starts,
                                  std::size_t path_points) {
  for (std::size_t i = 0; i < starts.size(); ++i) check_start(scene, stops, i, starts[i]);
  std::vector<TracedRay> rays(starts.size());
  std::visit(
      [&](const auto& field) {
        const auto run = [&](const auto& kind_of_steps) {
          const Tracer tracer(field, scene, stops, kind_of_steps, path_points);
          parallel_for(starts.size(), [&](std::size_t i) { rays[i] = tracer.trace(i, starts[i]); });
        };
        if (steps.integrator == "leapfrog")
          with_steps<grin::Leapfrog>(field, steps, run);
        else if (steps.integrator == "yoshida4")
          with_steps<grin::Yoshida4>(field, steps, run);
        else
          with_steps<grin::Sharma>(field, steps, run);
      },
      scene.field);
  return rays;
}

}  // namespace flatspeckle::apps
