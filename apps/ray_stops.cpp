#include "apps/ray_stops.h"

#include <algorithm>

#include "apps/key_values.h"
#include "core/error.h"
#include "grin/rays/watch.h"

namespace flatspeckle::apps {

namespace {

std::vector<grin::Surface> surfaces_of(const RayStopSpec& spec) {
  std::vector<grin::Surface> surfaces;
  for (const auto& plane :
       parts_of("stop_plane", spec.planes, 6, "a point and the normal outwards"))
    surfaces.push_back(grin::Plane{
        three(plane, 0), direction_of("stop_plane, normal", {plane[3], plane[4], plane[5]})});
  for (const auto& sphere : spheres_of("stop_sphere", spec.spheres)) surfaces.push_back(sphere);
  for (const auto& box : boxes_of("stop_box", spec.boxes)) surfaces.push_back(box);
  return surfaces;
}

/// The largest number that distances from it are differences of.
double size(const grin::Sphere& sphere) {
  return sphere.centre.cwiseAbs().maxCoeff() + sphere.radius;
}
double size(const grin::Plane& plane) {
  return plane.point.cwiseAbs().maxCoeff();
}
double size(const grin::Box& box) {
  return box.low.cwiseAbs().cwiseMax(box.high.cwiseAbs()).maxCoeff();
}
double size(const grin::DistanceGrid& grid) {
  return size(grin::Box{grid.low(), grid.high()});
}

}  // namespace

void add_ray_stop_options(Options& options, RayStopSpec& spec) {
  options.add("--stop_plane", spec.planes,
              "x y z nx ny nz: rays end on this plane; n points away from them");
  options.add("--stop_sphere", spec.spheres, "x y z radius: rays end on it, inside or outside");
  options.add("--stop_box", spec.boxes, "x y z x y z of two corners: rays end on it");
  options.add("--max_length", spec.max_length,
              "Rays and curves end at this arc length at the latest; always needed");
  options.add("--integrator", spec.integrator, "sharma (default), yoshida4 or leapfrog");
  options.add("--step", spec.step,
              "Equal steps, length at index 1; with a tolerance, or for curves, the longest step");
  options.add("--tolerance", spec.tolerance,
              "Error of a ray per length (default 1e-10, unless a step is given)");
}

double max_length_of(const RayStopSpec& spec) {
  if (!spec.max_length) throw InputError("max_length is not given: rays need an end");
  return positive("max_length", *spec.max_length);
}

RayStops make_ray_stops(const RayStopSpec& spec, double scale, double farthest) {
  RayStops stops{surfaces_of(spec), max_length_of(spec), 0};
  constexpr std::size_t seams = 2;  // the rim of a ball and the box of a grid
  constexpr auto most = grin::Watch::max_surfaces - seams;
  if (stops.surfaces.size() > most)
    throw InputError("stop surfaces", stops.surfaces.size(),
                     "must be at most " + std::to_string(most));
  for (const auto& surface : stops.surfaces)
    farthest = std::max(farthest, std::visit([](const auto& s) { return size(s); }, surface));
  const double rounding = std::max(1e-14 * stops.max_length, 4e-15 * farthest);
  stops.location = std::max(1e-10 * std::min(scale, stops.max_length), rounding);
  return stops;
}

RaySteps make_ray_steps(const RayStopSpec& spec, double scale) {
  if (spec.integrator != "sharma" && spec.integrator != "yoshida4" && spec.integrator != "leapfrog")
    throw InputError("integrator", spec.integrator, "must be one of leapfrog sharma yoshida4");
  RaySteps steps{spec.integrator, 0, {}};
  const double length = max_length_of(spec);
  steps.longest =
      spec.step ? positive("step", *spec.step) : std::min(length / 16, scale > 0 ? scale : length);
  if (spec.tolerance || !spec.step) {
    steps.tolerance = positive("tolerance", spec.tolerance.value_or(1e-10));
    if (*steps.tolerance < 1e-14 || *steps.tolerance > 0.1)
      throw InputError("tolerance", *steps.tolerance, "must be from 1e-14 to 0.1");
  }
  return steps;
}

}  // namespace flatspeckle::apps
