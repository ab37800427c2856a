#include "grin/rays/marching/ray_stops.h"

#include <algorithm>
#include <sstream>

#include "grin/media/geometry/vector_values.h"
#include "grin/rays/marching/watch.h"

namespace flatspeckle::grin {

namespace {

template <class... Integrator>
std::vector<std::string> words(const std::variant<Integrator...>&) {
  return {Integrator::word...};
}
template <class... Integrator>
Integrators named(const std::string& word, const std::variant<Integrator...>&) {
  Integrators found;
  ((word == Integrator::word ? void(found = Integrator()) : void()), ...);
  return found;
}

std::vector<Surface> surfaces_of(const Keys& keys, const RayStopValues& values) {
  std::vector<Surface> surfaces;
  for (const auto plane : parts_of(keys.read(values.stop_plane), 6))
    surfaces.push_back(
        Plane{vector_of(plane), unit_direction("stop_plane, normal", vector_of(plane, 3))});
  for (const Sphere& sphere : spheres_of(keys, values.stop_sphere)) surfaces.push_back(sphere);
  for (const Box& box : boxes_of(keys, values.stop_box)) surfaces.push_back(box);
  return surfaces;
}

/// Returns the largest absolute coordinate of a closed surface or of the given point of a plane.
double size(const Surface& surface) {
  if (const auto* plane = std::get_if<Plane>(&surface)) return plane->point.cwiseAbs().maxCoeff();
  const Box box = bounds(surface);
  return box.low.cwiseAbs().cwiseMax(box.high.cwiseAbs()).maxCoeff();
}

}  // namespace

void add_keys(Keys& keys, RayStopValues& values) {
  keys.group("Ends of rays");
  keys.add("stop_plane", values.stop_plane,
           "x y z nx ny nz: rays end on the plane through x y z; its normal n points away from the "
           "rays")
      .each_of(6, "a point and the normal outwards")
      .units("length length length 1 1 1");
  keys.add("stop_sphere", values.stop_sphere,
           "x y z radius: rays end on this sphere and may start inside or outside")
      .each_of(4, "centre and radius")
      .unit("length");
  keys.add("stop_box", values.stop_box,
           "x y z x y z: rays end on the box with these opposite corners, the low one first")
      .each_of(6, "two opposite corners, the low one first")
      .unit("length");
  keys.add("max_length", values.max_length,
           "Largest arc length of rays and curves; always required")
      .positive()
      .unit("length");
  keys.group("Steps of rays");
  keys.add("integrator", values.integrator,
           "Integrator of the ray equation: sharma and yoshida4 have order 4, leapfrog order 2")
      .one_of(words(Integrators()))
      .only_of("rays");
  keys.add("step", values.step,
           "Length of a step where the index is 1; with a tolerance, or for curves (connect), of "
           "the "
           "longest step")
      .positive()
      .unit("length");
  keys.add(
          "tolerance", values.tolerance,
          "Error of a ray divided by its length (default 1e-10; equal steps if only step is given)")
      .from(1e-14, 0.1)
      .only_of("rays");
}

RayStops make_ray_stops(const Keys& keys, const RayStopValues& values, double scale,
                        double farthest, std::span<const Surface> others) {
  RayStops stops{surfaces_of(keys, values), keys.required(values.max_length)};
  constexpr std::size_t seams = 2;  // reserved for the rim of a ball and the box of a grid
  constexpr auto most = Watch::max_surfaces - seams;
  if (stops.surfaces.size() + others.size() > most)
    throw InputError("stop surfaces and bodies", stops.surfaces.size() + others.size(),
                     "must be at most " + std::to_string(most));
  const double within_reach = farthest + stops.max_length;
  for (const std::span<const Surface> surfaces : {std::span<const Surface>(stops.surfaces), others})
    for (const auto& surface : surfaces)
      farthest = std::max(farthest, std::min(size(surface), within_reach));
  const double rounding = std::max(1e-14 * stops.max_length, 4e-15 * farthest);
  stops.location = std::max(1e-10 * std::min(scale, stops.max_length), rounding);
  return stops;
}

double curve_step(const Keys& keys, const RayStopValues& values, double scale) {
  const double length = keys.required(values.max_length);
  return keys.read(values.step).value_or(std::min(length / 16, scale > 0 ? scale : length));
}

RaySteps make_ray_steps(const Keys& keys, const RayStopValues& values, double scale) {
  RaySteps steps{named(keys.read(values.integrator), Integrators()),
                 curve_step(keys, values, scale), keys.read(values.tolerance)};
  constexpr double usual_tolerance = 1e-10;
  if (!values.step && !values.tolerance) steps.tolerance = usual_tolerance;
  return steps;
}

std::string describe(const RaySteps& steps) {
  std::ostringstream text;
  text << std::visit([](const auto& integrator) { return integrator.word; }, steps.integrator);
  if (steps.tolerance)
    text << ", tolerance " << *steps.tolerance << ", steps up to " << steps.longest;
  else
    text << ", step " << steps.longest;
  return text.str();
}

}  // namespace flatspeckle::grin
