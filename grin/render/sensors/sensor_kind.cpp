#include "grin/render/sensors/sensor_kind.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace flatspeckle::grin {

namespace {

/// Returns the point nearest to x on the faces of a box through which light along `forward` leaves.
Vec3 nearest_on(const Box& box, const Vec3& forward, const Vec3& x) {
  double least = std::numeric_limits<double>::infinity();
  int nearest = 0;
  const auto face = [&](int axis) { return forward[axis] > 0 ? box.high[axis] : box.low[axis]; };
  for (int axis = 0; axis < 3; ++axis) {
    const double distance = std::abs(face(axis) - x[axis]);
    if (forward[axis] == 0 || distance >= least) continue;
    least = distance;
    nearest = axis;
  }
  Vec3 found = x;
  found[nearest] = face(nearest);
  return found;
}
/// Returns the point nearest to x on the half of a sphere through which light along `forward`
/// leaves.
Vec3 nearest_on(const Sphere& sphere, const Vec3& forward, const Vec3& x) {
  Vec3 away = x - sphere.centre;
  away -= std::min(0.0, away.dot(forward)) * forward;
  const double length = away.norm();
  return sphere.centre + (length > 0 ? sphere.radius / length * away : sphere.radius * forward);
}

}  // namespace

DatasetTable sensor_table(const SensorWords& words) {
  std::string axes;
  for (const DatasetRow& axis : words.axes) axes += (axes.empty() ? "" : " ") + axis.path;
  const bool has_total = !words.total.empty();
  const std::string& whole = has_total ? words.total : words.mean;
  const std::string whole_unit = has_total ? "1" : words.unit;
  DatasetTable table{words.name, words.axes};
  const auto add = [&](const char* path, const std::string& along, const std::string& unit,
                       const std::string& long_name) {
    table.rows.push_back({path, Data::estimate, along, unit, long_name});
  };
  add("image", axes, words.unit, words.pixel);
  add("mean", "", words.unit, words.mean);
  if (has_total) add("total", "", "1", words.total);
  add("transient", axes + " optical_path", words.unit, words.pixel + ", in the bin");
  add("transient_before", axes, words.unit, words.pixel + ", of paths shorter than all bins");
  add("transient_after", axes, words.unit, words.pixel + ", of paths longer than all bins");
  add("pulse", "optical_path", whole_unit, whole + ", in the bin");
  add("pulse_before", "", whole_unit, whole + ", of paths shorter than all bins");
  add("pulse_after", "", whole_unit, whole + ", of paths longer than all bins");
  add("image_path", axes, "length", "mean optical path of the pixel's light; 0 without light");
  add("image_path_square", axes, "length^2", "mean squared optical path");
  add("mean_path", "", "length", "mean optical path of the sensor's light");
  add("mean_path_square", "", "length^2", "mean squared optical path");
  add("image_gradient", "parameter " + axes, "", "derivative of image");
  add("mean_gradient", "parameter", "", "derivative of mean");
  if (has_total) add("total_gradient", "parameter", "", "derivative of total");
  add("image_correlation", "delay " + axes, "1",
      "field correlation g1 of the pixel's light after a delay; 0 without light");
  add("mean_correlation", "delay", "1", "field correlation g1 of the sensor's light after a delay");
  add("pulse_correlation", "delay optical_path", "1",
      "field correlation g1 of the sensor's light in the bin; 0 without light");
  add("mean_transfer", "body", "1",
      "mean momentum transfer of the sensor's light: sum over collisions of 1 - cos");
  add("correlation_gradient", "body delay", "1",
      "derivative of mean_correlation by the diffusion factor of a body");
  add("image_sideband", "sideband " + axes, "1",
      "fraction of the pixel's light that the sound shifts by this number of its frequencies");
  add("mean_sideband", "sideband", "1", "the same fraction of the sensor's light");
  add("mean_modulation", "", "1",
      "mean square of the amplitude, in rad, by which the sound modulates the phases of paths");
  return table;
}

NearestPlace in_front(const Vec3& forward, const Surface& boundary) {
  if (const auto* box = std::get_if<Box>(&boundary))
    return [box = *box, forward](const Vec3& x) { return nearest_on(box, forward, x); };
  return [sphere = std::get<Sphere>(boundary), forward](const Vec3& x) {
    return nearest_on(sphere, forward, x);
  };
}

}  // namespace flatspeckle::grin
