#include "mc/imaging/line_camera.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "core/error.h"
#include "mc/paths/speckle/speckle_field.h"

namespace flatspeckle::mc {

namespace {

/// Returns the distance from a line at the depth z to the box; negative if the line is inside.
double distance_to(const Domain& domain, double z) {
  return std::max(-z, z - domain.depth);
}

void require_outside(const Scene& medium, const std::string& key, double z) {
  if (!(distance_to(medium.domain, z) > medium.scatterer.radius))
    throw InputError(key, z,
                     "must be outside of the box, 0 to " + std::to_string(medium.domain.depth) +
                         ", by more than a scatterer's radius");
}

/// Returns the displacement of speckle on the camera, per unit sine of the tilt of the light.
double length_of_sine(const LineScene& line) {
  return line.camera.depth ? distance_to(line.scene.domain, *line.camera.depth) : 1;
}

}  // namespace

View view_at(const LineCamera& camera, double pixel) {
  const double place = camera.place(pixel);
  return camera.depth ? near_sensor({place, *camera.depth}) : far_view(std::asin(place));
}

LineScene line_scene(Scene medium, LineObject object, double object_depth, const LineCamera& camera,
                     std::optional<double> reference) {
  if (medium.faces)
    throw InputError("medium_index", medium.faces->inside,
                     "requires dimension = 3, an object at infinity and a camera of far views");
  require_outside(medium, "object_depth", object_depth);
  if (camera.depth) require_outside(medium, "camera_depth", *camera.depth);
  Lights lights;
  for (const double x : object.x) lights.push_back(point_source({x, object_depth}));
  if (reference) lights.push_back(point_source({*reference, object_depth}));
  for (const Light& light : lights) require_reach("object_depth", light.point, medium);
  if (camera.depth)
    for (const double x : {camera.first, camera.last})
      require_reach("camera_depth", {x, *camera.depth}, medium);
  std::vector<View> views;
  for (std::size_t p = 0; p < camera.pixels; ++p)
    views.push_back(view_at(camera, static_cast<double>(p)));
  medium.request = field_request(std::move(lights), std::move(views));
  return {std::move(medium), std::move(object), object_depth, camera, reference};
}

double most_grains(const LineScene& line) {
  const double sines = (line.camera.last - line.camera.first) / length_of_sine(line);
  return std::min(sines, 2.0) * line.scene.domain.width / line.scene.wavelength;
}

double magnification(const LineScene& line) {
  const double tilt = -1 / distance_to(line.scene.domain, line.object_depth);
  return tilt * length_of_sine(line) / line.camera.step();
}

double shift_of(const LineScene& line, double x) {
  const double distance = distance_to(line.scene.domain, line.object_depth);
  return magnification(line) * distance * x / std::hypot(x, distance);
}

LineObject shifts(const LineScene& line) {
  LineObject object = line.object;
  for (double& x : object.x) x = shift_of(line, x) - shift_of(line, line.reference.value_or(0));
  return object;
}

}  // namespace flatspeckle::mc
