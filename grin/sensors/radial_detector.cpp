#include "grin/sensors/radial_detector.h"

#include <cmath>
#include <numbers>

#include "grin/sensors/sensor_table.h"

namespace flatspeckle::grin {

using std::numbers::pi;

const DatasetTable radial_table = sensor_table(
    {.name = "radial",
     .axes = {{"radius", Data::scale, "", "length", "middle of the ring: distance from sensor_at"}},
     .unit = "1/length^2",
     .pixel = "irradiance averaged over the ring",
     .mean = "irradiance averaged over the disk",
     .total = "power on the disk"});

PixelRings picture_of(const RadialDetector& detector) {
  return {PixelRings::Of::radius, detector.rings, detector.radius};
}

RadialDetectorEnd::RadialDetectorEnd(const RadialDetector& detector, const Stage& stage)
    : rings_(picture_of(detector)),
      patch_(stage.boundary, detector.centre, detector.radius, "sensor_at", "sensor_radius"),
      centre_(boundary_point(stage.boundary, detector.centre)->x),
      acceptance_(detector.acceptance),
      regions_(stage) {
  require_in_stage(stage, centre_);
}

EndPosition RadialDetectorEnd::on_ring(const BoundaryPoint& at, int ring) const {
  return {.point = {at.x, regions_.at(at.x)},
          .inward = at.inward,
          .position_density = rings_.density(ring),
          .pixel = ring};
}

EndPosition RadialDetectorEnd::sample_position(double stratum, RandomStream& random) const {
  const auto [within, ring] = rings_.sample(stratum, random);
  return on_ring(patch_.polar(std::sqrt(within / pi), 2 * pi * random.uniform()), ring);
}

std::optional<EndPosition> RadialDetectorEnd::position_at(const Vec3& x) const {
  const int ring = rings_.ring_at((x - centre_).norm());
  if (ring < 0 || !patch_.contains(x)) return std::nullopt;
  return on_ring({x, patch_.inward(x)}, ring);
}

void add_keys(Keys& keys, RadialValues& values) {
  add_vectors(keys, "sensor_at", values.sensor_at, "The middle of the disk, on the boundary")
      .unit("length");
  keys.add("sensor_radius", values.sensor_radius, "Of the disk").positive().unit("length");
  keys.add("rings", values.rings, "Equal steps of the radius").from(1, 16384);
  keys.add("acceptance", values.acceptance, "Half angle about the normal")
      .positive_to(pi / 2)
      .unit("rad");
}

RadialDetector make_sensor(const OneSensor& of, const RadialValues& values) {
  return {of.vector(values.sensor_at), of.number(values.sensor_radius),
          static_cast<int>(of.part(values.rings, 1)[0]), of.number(values.acceptance)};
}

}  // namespace flatspeckle::grin
