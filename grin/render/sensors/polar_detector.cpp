#include "grin/render/sensors/polar_detector.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "grin/media/scattering/start_directions.h"
#include "grin/render/sensors/sensor_kind.h"

namespace flatspeckle::grin {

using std::numbers::pi;

const DatasetTable polar_table = sensor_table(
    {.name = "polar",
     .axes = {{"angle", Data::scale, "", "rad", "middle of the ring: angle from sensor_direction"}},
     .unit = "1/sr",
     .pixel = "power per solid angle averaged over the ring",
     .mean = "power per solid angle averaged over all rings",
     .total = "power in all rings"});

PixelRings picture_of(const PolarDetector& detector) {
  return {PixelRings::Of::angle, detector.rings, detector.half_angle};
}

PolarDetectorEnd::PolarDetectorEnd(const PolarDetector& detector, const Stage& stage)
    : WholeBoundary(stage),
      axis_(unit_direction("sensor_direction", detector.axis)),
      rings_(picture_of(detector)) {}

EndDirection PolarDetectorEnd::along(const EndPosition& at, const Vec3& direction, int ring) const {
  EndDirection to{.direction = direction, .density = rings_.density(ring)};
  const double cosine = direction.dot(at.inward);
  if (!(cosine > 0)) return to;  // no light leaves the stage in this direction at this position
  to.pixel = ring;
  to.strength = at.index * at.index * cosine / rings_.area(ring);
  return to;
}

EndDirection PolarDetectorEnd::sample_direction(const EndPosition& at, double stratum,
                                                RandomStream& random) const {
  const auto [within, ring] = rings_.sample(stratum, random);
  return along(at, -random_turn(axis_, within / (2 * pi), random), ring);
}

EndDirection PolarDetectorEnd::towards(const EndPosition& at, const Vec3& direction) const {
  const double angle = std::atan2(direction.cross(axis_).norm(), -direction.dot(axis_));
  const int ring = rings_.ring_at(angle);
  return ring < 0 ? EndDirection{.direction = direction} : along(at, direction, ring);
}

void add_keys(Keys& keys, PolarValues& values) {
  add_vectors(keys, "sensor_direction", values.sensor_direction, "Direction of polar angle 0");
  keys.add("largest_angle", values.largest_angle,
           "Largest polar angle, up to which directions are divided into rings")
      .positive_to(pi)
      .unit("rad");
  keys.add("rings", values.rings, "Number of rings, of equal width in angle").from(1, 16384);
}

PolarDetector make_sensor(const OneSensor& of, const PolarValues& values) {
  return {of.vector(values.sensor_direction), of.number(values.largest_angle),
          static_cast<int>(of.part(values.rings, 1)[0])};
}

}  // namespace flatspeckle::grin
