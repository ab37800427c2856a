#include "grin/ends/sensor.h"

namespace flatspeckle::grin {

namespace {

using End = std::variant<CameraEnd, AreaDetectorEnd, DirectionalEnd>;

End sensor_end(const Camera& camera, const Stage& stage) {
  return CameraEnd(camera, stage);
}
End sensor_end(const AreaDetector& detector, const Stage& stage) {
  return AreaDetectorEnd(detector, stage);
}
End sensor_end(const DirectionalDetector& detector, const Stage& stage) {
  return DirectionalEnd(detector, stage);
}

}  // namespace

const DatasetTable& table_of(const Sensor& sensor) {
  static constexpr const DatasetTable* tables[] = {&camera_table, &area_table, &directional_table};
  return *tables[sensor.index()];
}

PixelRectangle picture_of(const Sensor& sensor) {
  return std::visit([](const auto& kind) { return picture_of(kind); }, sensor);
}

SensorEnd::SensorEnd(const Sensor& sensor, const Stage& stage)
    : end_(std::visit([&](const auto& s) { return sensor_end(s, stage); }, sensor)) {}

EndDirection SensorEnd::sample_direction(const EndPosition& at, RandomStream& random,
                                         double stratum) const {
  return std::visit([&](const auto& end) { return end.sample_direction(at, stratum, random); },
                    end_);
}

bool SensorEnd::can_be_hit() const {
  const auto* camera = std::get_if<CameraEnd>(&end_);
  return !camera || !camera->is_pinhole();
}

EndDirection SensorEnd::towards(const EndPosition& at, const Vec3& direction) const {
  return std::visit([&](const auto& end) { return end.towards(at, direction); }, end_);
}

}  // namespace flatspeckle::grin
