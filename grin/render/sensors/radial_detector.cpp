#include "grin/render/sensors/radial_detector.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>

#include "core/keys/number_text.h"
#include "grin/media/geometry/frame.h"
#include "grin/render/sensors/area_detector.h"
#include "grin/render/sensors/sensor_kind.h"

namespace flatspeckle::grin {

using std::numbers::pi;

namespace {

DatasetTable table() {
  DatasetTable table = sensor_table({.name = "radial",
                                     .axes = {{"radius", Data::scale, "", "length",
                                               "middle of the ring: distance from sensor_at"}},
                                     .unit = "1/length^2",
                                     .pixel = "irradiance averaged over the ring",
                                     .mean = "irradiance averaged over the disk",
                                     .total = "power on the disk"});
  const auto add = [&](const DatasetRow& row) { table.rows.push_back(row); };
  add({"disk_radius", Data::scale, "", "length", "radius of a disk listed in radii"});
  add({"other_disk_radius", Data::scale, "", "length", "radius of a disk listed in radii"});
  add({"power_within", Data::estimate, "disk_radius", "1", "power on the disk"});
  add({"power_within_covariance", Data::real, "disk_radius other_disk_radius", "1",
       "covariance of the errors of the powers on two disks"});
  add({"power_within_gradient", Data::estimate, "parameter disk_radius", "",
       "derivative of power_within"});
  return table;
}

}  // namespace

const DatasetTable radial_table = table();

PixelRings picture_of(const RadialDetector& detector) {
  if (!detector.radii.empty()) return PixelRings(detector.radii);
  return {PixelRings::Of::radius, detector.rings, detector.radius};
}

RadialDetectorEnd::RadialDetectorEnd(const RadialDetector& detector, const Stage& stage)
    : rings_(picture_of(detector)),
      patch_(stage.boundary, detector.centre, detector.radius, "sensor_at", "sensor_radius"),
      centre_(boundary_point(stage.boundary, detector.centre)->x),
      acceptance_(detector.acceptance),
      regions_(stage) {
  require_in_stage(stage, "sensor_at", centre_);
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
  add_vectors(keys, "sensor_at", values.sensor_at, "Centre of the disk, on the boundary")
      .unit("length");
  keys.add("sensor_radius", values.sensor_radius, "Radius of the disk").positive().unit("length");
  keys.add("radii", values.radii,
           "Increasing radii of concentric disks: measures the power on each; replaces "
           "sensor_radius and rings")
      .positive()
      .unit("length");
  keys.add("rings", values.rings, "Number of rings, of equal width").from(1, 16384);
  keys.add("acceptance", values.acceptance, "Light is accepted within this angle from the normal")
      .positive_to(pi / 2)
      .unit("rad");
}

RadialDetector make_sensor(const OneSensor& of, const RadialValues& values) {
  if (const auto& radii = of.all(values.radii); !radii.empty()) {
    if (!std::is_sorted(radii.begin(), radii.end(), std::less_equal<double>()))
      throw InputError("radii", number_text(radii), "must increase");
    of.refuse_beside("radii", values.sensor_radius);
    of.refuse_beside("radii", values.rings);
    return {of.vector(values.sensor_at), radii.back(), static_cast<int>(radii.size()),
            of.number(values.acceptance), radii};
  }
  return {of.vector(values.sensor_at), of.number(values.sensor_radius),
          static_cast<int>(of.part(values.rings, 1)[0]), of.number(values.acceptance)};
}

/// The returned function treats the disk as the square around it.
NearestPlace nearest_place(const RadialDetector& detector, const Surface& boundary) {
  const Vec3 normal = grin::normal(boundary, detector.centre);
  const double side = 2 * detector.radius;
  return nearest_place(
      AreaDetector{detector.centre, frame_across(normal).col(0), side, side, {}, 0}, boundary);
}

}  // namespace flatspeckle::grin
