#include "grin/ends/sensor_datasets.h"

#include <cmath>

namespace flatspeckle::grin {

const DatasetTable camera_table{
    "camera",
    {{"row", Data::scale, "", "1", "tangent of the angle above the line of sight"},
     {"column", Data::scale, "", "1", "tangent of the angle to the right of it"},
     {"image", Data::estimate, "row column", "1/(length^2 sr)", "L/n^2 averaged over the pixel"},
     {"mean", Data::estimate, "", "1/(length^2 sr)", "mean over the pixels"},
     {"transient", Data::estimate, "row column optical_path", "1/(length^2 sr)",
      "L/n^2 averaged over the pixel, in the bin"},
     {"pulse", Data::estimate, "optical_path", "1/(length^2 sr)",
      "mean over the pixels, in the bin"}}};

const DatasetTable area_table{
    "area",
    {{"row", Data::scale, "", "length", "height on the detector, along sensor_up"},
     {"column", Data::scale, "", "length", "position to the right, as light that arrives sees it"},
     {"image", Data::estimate, "row column", "1/length^2", "irradiance averaged over the pixel"},
     {"mean", Data::estimate, "", "1/length^2", "mean over the pixels"},
     {"total", Data::estimate, "", "1", "power on the detector"},
     {"transient", Data::estimate, "row column optical_path", "1/length^2",
      "irradiance averaged over the pixel, in the bin"},
     {"pulse", Data::estimate, "optical_path", "1", "power on the detector, in the bin"}}};

const DatasetTable directional_table{
    "directional",
    {{"row", Data::scale, "", "1", "component of the direction along sensor_up"},
     {"column", Data::scale, "", "1",
      "component of the direction along sensor_direction x sensor_up"},
     {"image", Data::estimate, "row column", "1/sr",
      "power per solid angle averaged over the pixel"},
     {"mean", Data::estimate, "", "1/sr", "mean over the pixels"},
     {"transient", Data::estimate, "row column optical_path", "1/sr",
      "power per solid angle averaged over the pixel, in the bin"},
     {"pulse", Data::estimate, "optical_path", "1/sr", "mean over the pixels, in the bin"}}};

namespace {

/// Centres of `count` equal parts of (-half, half).
std::vector<double> centres(double half, int count) {
  std::vector<double> values;
  for (int i = 0; i < count; ++i) values.push_back(half * ((2 * i + 1.0) / count - 1));
  return values;
}

SensorAxes sides(double half_width, double half_height, const PixelGrid& pixels) {
  SensorAxes axes{centres(half_height, pixels.rows), centres(half_width, pixels.columns)};
  for (double& height : axes.row) height = -height;  // row 0 is on top
  return axes;
}

SensorAxes axes_of_kind(const Camera& camera) {
  const double half = std::tan(camera.field_of_view / 2);
  return sides(half, half * camera.pixels.rows / camera.pixels.columns, camera.pixels);
}

SensorAxes axes_of_kind(const AreaDetector& detector) {
  SensorAxes axes = sides(detector.width / 2, detector.height / 2, detector.pixels);
  axes.area = detector.width * detector.height;
  return axes;
}

SensorAxes axes_of_kind(const DirectionalDetector& detector) {
  const double half = std::sin(detector.half_angle);
  return sides(half, half, detector.pixels);
}

}  // namespace

const DatasetTable& table_of(const Sensor& sensor) {
  static constexpr const DatasetTable* tables[] = {&camera_table, &area_table, &directional_table};
  return *tables[sensor.index()];
}

SensorAxes axes_of(const Sensor& sensor) {
  return std::visit([](const auto& kind) { return axes_of_kind(kind); }, sensor);
}

}  // namespace flatspeckle::grin
