#include "mc/imaging/unmixing/unmixing_datasets.h"

#include <functional>

#include "core/result/result_group.h"

namespace flatspeckle::mc {

const DatasetTable unmixing_table{
    .name = "sources",
    .rows = {
        {"frame", Data::numbers, "", "1", "number of the frame"},
        {"frame_name", Data::text, "frame", "", "its column"},
        {"pixel", Data::numbers, "", "1", "along the line"},
        {"source", Data::numbers, "", "1", "number of the source"},
        {"singular_value", Data::real, "frame", "1",
         "of the frames over their mean, the camera's noise white where it is known, largest "
         "first"},
        {"noise_level", Data::real, "", "1", "singular values above it are sources"},
        {"source_count", Data::count, "", "1", "sources that the singular values tell"},
        {"factor_residual", Data::real, "", "1", "rms of what the factors leave, over the light's"},
        {"source_pattern", Data::real, "source pixel", "1", "of each source alone, mean 1"},
        {"source_brightness", Data::real, "frame source", "1", "in units of all frames' mean"},
        {"source_x", Data::real, "source", "1", "pixels from the first of its group, not mirrored"},
        {"source_group", Data::count, "source", "1",
         "sources of one number are placed to each other; 0: the largest group"}}};

std::vector<double> row_by_row(const Eigen::MatrixXd& matrix) {
  const Eigen::MatrixXd turned = matrix.transpose();
  return {turned.data(), turned.data() + turned.size()};
}

void write_unmixed(ResultFile& file, const std::vector<std::string>& names, const Unmixed& found) {
  const ResultGroup root(file, unmixing_table);
  root.number("frame", names.size());
  root.put("frame_name", names);
  root.put("singular_value", found.count.singular_values);
  root.put("noise_level", found.count.threshold);
  root.put("source_count", static_cast<std::uint64_t>(found.count.sources));
  if (found.places.x.empty()) return;
  root.number("pixel", static_cast<std::size_t>(found.factors.pattern.rows()));
  root.number("source", found.places.x.size());
  root.put("factor_residual", found.factors.residual);
  root.put("source_pattern", row_by_row(found.factors.pattern.transpose()));
  root.put("source_brightness", row_by_row(found.factors.brightness));
  root.put("source_x", found.places.x);
  root.put("source_group", column(found.places.group, std::identity()));
}

}  // namespace flatspeckle::mc
