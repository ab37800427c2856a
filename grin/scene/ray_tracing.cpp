#include "grin/scene/ray_tracing.h"

#include "core/run/parallel.h"
#include "grin/curved/ray_field.h"

namespace flatspeckle::grin {

namespace {

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
    if (const auto* plane = std::get_if<Plane>(&surface);
        plane && plane->distance(start.x) > stops.location)
      refuse("behind stop_plane = " + listed(plane->point) + ' ' + listed(plane->outwards));
}

class BundleTracer {
 public:
  BundleTracer(const SceneField& scene, const RayStops& stops, const RaySteps& steps,
               std::size_t path_points)
      : scene_(scene),
        stops_(stops),
        steps_(steps),
        path_points_(path_points),
        surfaces_(stops.surfaces),
        inside_(make_ray_field(scene.field)),
        outside_(
            std::visit([](const auto& field) { return make_ray_field(field); }, scene.outside)) {
    if (scene.grid) surfaces_.push_back(*scene.grid);
    if (scene.rim) surfaces_.push_back(*scene.rim);
  }

  TracedRay trace(std::size_t number, const RayStart& start) const {
    RayLog log(steps_, path_points_ > 0);
    RayState ray{start.x, index_at(scene_, start.x) * start.direction};
    log.start(ray);
    TracedRay traced{.first = invariants(ray)};
    const TraceEnd end = follow(number, log, ray, traced.steps);
    traced.end = ray;
    traced.last = invariants(ray);
    traced.index_mismatch = log.index_mismatch();
    traced.status = end.stop == Stop::length          ? RayStatus::length
                    : end.surface < number_of_stops() ? RayStatus::surface
                                                      : RayStatus::edge_of_grid;
    const bool is_stop = traced.status == RayStatus::surface;
    traced.surface = static_cast<std::uint64_t>(is_stop ? end.surface : number_of_stops());
    if (path_points_ > 0) traced.path = log.path().points(path_points_);
    return traced;
  }

 private:
  int number_of_stops() const { return static_cast<int>(stops_.surfaces.size()); }
  RayInvariants invariants(const RayState& ray) const {
    return ray_invariants(*inside_, ray, scene_.centre, scene_.axis);
  }

  /// From rim to rim, until the ray ends.
  TraceEnd follow(std::size_t number, RayLog& log, RayState& ray, std::uint64_t& made) const {
    constexpr int most_rims = 100'000;
    if (leaves_grid(ray)) return {.stop = Stop::surface, .surface = number_of_stops()};
    for (int i = 0; i < most_rims; ++i) {
      const RayField& field = is_outside(ray) ? *outside_ : *inside_;
      const TraceLimits limits{stops_.max_length - ray.arc_length, stops_.location};
      const TraceEnd end = field.follow(surfaces_, limits, log, ray);
      made += static_cast<std::uint64_t>(end.steps);
      if (end.stop == Stop::lost) throw lost(number, end, ray);
      const bool at_rim = scene_.rim && end.surface + 1 == static_cast<int>(surfaces_.size());
      if (end.stop == Stop::length || !at_rim) return end;
    }
    throw InputError("max_length", stops_.max_length, name(number) + " meets the rim too often");
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

  InputError lost(std::size_t number, const TraceEnd& end, const RayState& ray) const {
    constexpr long most_steps = TraceLimits{}.max_steps;
    if (end.steps >= most_steps)
      return InputError("max_length", stops_.max_length,
                        name(number) + " takes more than " + std::to_string(most_steps) +
                            " steps; they may be longer");
    const std::string where = ray.x.allFinite() ? ", near " + listed(ray.x) : "";
    return InputError(
        name(number) +
        " comes to where the index is not above 0, or changes too fast for the tolerance" + where);
  }

  const SceneField& scene_;
  const RayStops& stops_;
  const RaySteps& steps_;
  std::size_t path_points_;
  std::vector<Surface> surfaces_;
  std::unique_ptr<const RayField> inside_, outside_;  ///< of the rim
};

}  // namespace

std::vector<TracedRay> trace_rays(const SceneField& scene, const RayStops& stops,
                                  const RaySteps& steps, const std::vector<RayStart>& starts,
                                  std::size_t path_points) {
  for (std::size_t i = 0; i < starts.size(); ++i) check_start(scene, stops, i, starts[i]);
  std::vector<TracedRay> rays(starts.size());
  const BundleTracer tracer(scene, stops, steps, path_points);
  parallel_for(starts.size(), [&](std::size_t i) { rays[i] = tracer.trace(i, starts[i]); });
  return rays;
}

}  // namespace flatspeckle::grin
