#include "grin/render/sensors/sensor_kind.h"

namespace flatspeckle::grin {

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
  add("image_path", axes, "length", "mean optical path of the pixel's light; 0 where none came");
  add("image_path_square", axes, "length^2", "mean of its square");
  add("mean_path", "", "length", "mean optical path of the sensor's light");
  add("mean_path_square", "", "length^2", "mean of its square");
  add("image_gradient", "parameter " + axes, "", "derivative of image");
  add("mean_gradient", "parameter", "", "derivative of mean");
  if (has_total) add("total_gradient", "parameter", "", "derivative of total");
  return table;
}

}  // namespace flatspeckle::grin
