#include "grin/render/sensors/directional_detector.h"

#include <cmath>
#include <numbers>

#include "grin/render/sensors/sensor_kind.h"

namespace flatspeckle::grin {

const DatasetTable directional_table = sensor_table(
    {.name = "directional",
     .axes = {{"row", Data::scale, "", "1", "component of the direction along sensor_up"},
              {"column", Data::scale, "", "1",
               "component of the direction along sensor_direction x sensor_up"}},
     .unit = "1/sr",
     .pixel = "power per solid angle averaged over the pixel",
     .mean = "mean over the pixels"});

PixelRectangle picture_of(const DirectionalDetector& detector) {
  const double sine = std::sin(detector.half_angle);
  return {detector.pixels, sine, sine};
}

DirectionalEnd::DirectionalEnd(const DirectionalDetector& detector, const Stage& stage)
    : WholeBoundary(stage),
      view_("sensor_direction", detector.forward, detector.up),
      picture_(picture_of(detector)) {}

EndDirection DirectionalEnd::along(const EndPosition& at, const Vec3& direction, int pixel) const {
  EndDirection to{.direction = direction};
  const double picture_per_angle = -direction.dot(view_.forward);
  const double cosine = direction.dot(at.inward);
  to.density = picture_per_angle / picture_.area();
  if (!(cosine > 0)) return to;  // no light leaves the stage in this direction at this position
  to.pixel = pixel;
  to.strength = at.index * at.index * cosine * picture_per_angle / picture_.pixel_area();
  return to;
}

EndDirection DirectionalEnd::sample_direction(const EndPosition& at, double stratum,
                                              RandomStream& random) const {
  const PicturePoint seen = picture_.sample(stratum, random);
  const double squared = 1 - seen.u * seen.u - seen.v * seen.v;
  // a corner of the picture, where no direction exists
  if (!(squared > 0)) return {.direction = at.inward, .density = 1};
  const Vec3 leaving =
      seen.u * view_.right + seen.v * view_.up + std::sqrt(squared) * view_.forward;
  return along(at, -leaving, seen.pixel);
}

EndDirection DirectionalEnd::towards(const EndPosition& at, const Vec3& direction) const {
  const int pixel = direction.dot(view_.forward) < 0
                        ? picture_.pixel_at(-direction.dot(view_.right), -direction.dot(view_.up))
                        : -1;
  if (pixel < 0) return {.direction = direction};
  return along(at, direction, pixel);
}

void add_keys(Keys& keys, DirectionalValues& values) {
  add_vectors(keys, "sensor_direction", values.sensor_direction,
              "Direction at the centre of the picture");
  keys.add("half_angle", values.half_angle,
           "Angle from the central direction to the middle of a side of the picture")
      .positive_to(std::numbers::pi / 2)
      .unit("rad");
}

DirectionalDetector make_sensor(const OneSensor& of, const DirectionalValues& values,
                                const Picture& picture) {
  return {of.vector(values.sensor_direction), picture.up, of.number(values.half_angle),
          picture.pixels};
}

}  // namespace flatspeckle::grin
