#include "mc/imaging/simulated/picture_scene.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <utility>

#include "core/error.h"
#include "mc/paths/speckle/speckle_field.h"

namespace flatspeckle::mc {

namespace {

/// Returns the distance of a depth from the box; negative inside.
double distance_to_box(const Domain& box, double z) {
  return std::max(-z, z - box.depth);
}

double standard_deviation(double full_width) {
  return full_width / std::sqrt(8 * std::numbers::ln2);
}

}  // namespace

double pixel_step(const FarCamera& camera) {
  return 2 * camera.aperture / static_cast<double>(camera.pixels);
}

double PictureScene::grains() const {
  const double sines = 2 * camera().aperture * scene.outside_k() / (2 * std::numbers::pi);
  return sines * scene.domain.width * sines * scene.domain.height;
}

Light light_of(const PictureObject& object, Vec place) {
  if (!object.far) return point_source(place);
  return plane_wave(std::asin(std::hypot(place.x, place.y)), std::atan2(-place.y, -place.x));
}

PictureScene picture_scene(Scene medium, PictureObject object, const FarCamera& camera) {
  if (medium.faces && !object.far)
    throw InputError("medium_index", medium.faces->inside,
                     "requires an object at infinity: leave object_depth out");
  Lights lights;
  for (const Vec& place : object.place) {
    lights.push_back(light_of(object, place));
    if (object.far && !(std::hypot(place.x, place.y) < 1))
      throw InputError("object_x, object_y: without object_depth they are sines of directions, " +
                       std::to_string(place.x) + " and " + std::to_string(place.y) +
                       " are of none");
    if (object.far) continue;
    if (!(distance_to_box(medium.domain, place.z) > medium.scatterer.radius))
      throw InputError("object_depth", place.z,
                       "must be outside of the box, 0 to " + std::to_string(medium.domain.depth) +
                           ", by more than a scatterer's radius");
    require_reach("object_depth", place, medium);
  }
  medium.request = field_request(std::move(lights), camera.views());
  medium.request.camera = camera;
  return {std::move(medium), std::move(object)};
}

namespace {

struct Cuboid {
  Vec low, high;
};

Cuboid bounds_in_space(const PictureObject& object) {
  Cuboid box{object.place.front(), object.place.front()};
  for (const Vec& p : object.place)
    for (double Vec::*const along : {&Vec::x, &Vec::y, &Vec::z}) {
      box.low.*along = std::min(box.low.*along, p.*along);
      box.high.*along = std::max(box.high.*along, p.*along);
    }
  return box;
}

}  // namespace

Vec middle_of(const PictureObject& object) {
  const auto [low, high] = bounds_in_space(object);
  return 0.5 * (low + high);
}

double extent_of(const PictureObject& object) {
  const auto [low, high] = bounds_in_space(object);
  return std::max(high.x - low.x, high.y - low.y);
}

PixelPlace place_in_picture(const PictureScene& scene, Vec place) {
  double scale = 1 / pixel_step(scene.camera());
  if (!scene.object.far)
    scale /= std::hypot(place.x, place.y, distance_to_box(scene.scene.domain, place.z));
  return {scale * place.x, scale * place.y};
}

double picture_scale(const PictureScene& scene) {
  const double step = pixel_step(scene.camera());
  if (scene.object.far) return 1 / step;
  return 1 / (step * distance_to_box(scene.scene.domain, middle_of(scene.object).z));
}

std::vector<double> true_picture(const PictureScene& scene, std::size_t side, double width) {
  const double half = (static_cast<double>(side) - 1) / 2, sigma = standard_deviation(width);
  const PixelPlace middle = place_in_picture(scene, middle_of(scene.object));
  const auto gaussian = [&](std::size_t pixel, double at) {
    const double off = (static_cast<double>(pixel) - half - at) / sigma;
    return std::exp(-off * off / 2);
  };
  std::vector<double> picture(side * side);
  double sum = 0;
  for (std::size_t n = 0; n < scene.object.place.size(); ++n) {
    const PixelPlace at = place_in_picture(scene, scene.object.place[n]);
    for (std::size_t y = 0; y < side; ++y)
      for (std::size_t x = 0; x < side; ++x) {
        const double value = scene.object.brightness[n] * gaussian(y, at.y - middle.y) *
                             gaussian(x, at.x - middle.x);
        picture[y * side + x] += value;
        sum += value;
      }
  }
  for (double& value : picture) value /= sum;
  return picture;
}

}  // namespace flatspeckle::mc
