#include "mc/imaging/line_camera.h"

#include <cmath>
#include <string>
#include <utility>

#include "core/error.h"
#include "mc/speckle/speckle_field.h"

namespace flatspeckle::mc {

namespace {

/// From a line to the box; negative inside.
double distance_to(const Domain& domain, double z) {
  return std::max(-z, z - domain.depth);
}

void require_outside(const Scene& medium, const std::string& key, double z) {
  if (!(distance_to(medium.domain, z) > medium.scatterer.radius))
    throw InputError(key, z,
                     "must be outside of the box, 0 to " + std::to_string(medium.domain.depth) +
                         ", by more than a scatterer's radius");
}

}  // namespace

View view_at(const LineCamera& camera, double pixel) {
  const double place = camera.first + camera.step() * pixel;
  return camera.depth ? near_sensor({place, *camera.depth}) : far_view(std::asin(place));
}

LineScene line_scene(Scene medium, LineObject object, double object_depth,
                     const LineCamera& camera) {
  require_outside(medium, "object_depth", object_depth);
  if (camera.depth) require_outside(medium, "camera_depth", *camera.depth);
  Lights lights;
  for (const double x : object.x) lights.push_back(point_source({x, object_depth}));
  std::vector<View> views;
  for (std::size_t p = 0; p < camera.pixels; ++p)
    views.push_back(view_at(camera, static_cast<double>(p)));
  medium.request = field_request(std::move(lights), std::move(views));
  return {std::move(medium), std::move(object), object_depth, camera};
}

double most_grains(const LineScene& line) {
  const Domain& domain = line.scene.domain;
  const double range = line.camera.last - line.camera.first,
               away = line.camera.depth ? distance_to(domain, *line.camera.depth) : 1;
  return std::min(range / away, 2.0) * domain.width / line.scene.wavelength;
}

double magnification(const LineScene& line) {
  const Domain& domain = line.scene.domain;
  const double tilt = -1 / distance_to(domain, line.object_depth);
  const double away = line.camera.depth ? distance_to(domain, *line.camera.depth) : 1;
  return tilt * away / line.camera.step();
}

}  // namespace flatspeckle::mc
