#include "apps/results/exported_file.h"

#include <algorithm>
#include <sstream>

#include "apps/results/array_files.h"
#include "core/error.h"
#include "core/keys/number_text.h"
#include "core/result/result_reader.h"
#include "grin/media/fields/scene_field.h"
#include "grin/media/geometry/vector_values.h"

namespace flatspeckle::apps {

namespace {

/// Index at points of a box, [x][y][z].
struct SampledIndex {
  NumberArray index;
  grin::Vec3 origin, spacing;
};

/// Reads the field of a result of `design` as `trace` does.
grin::SceneField field_of(const std::string& path, const std::string& dataset) {
  grin::IndexFieldValues values;
  if (dataset == "ball_spline") {
    values.field = {grin::BallValues::word};
    values.of<grin::BallValues>().ball = path;
  } else if (dataset == "radial_spline") {
    values.field = {grin::RadialSplineValues::word};
    values.of<grin::RadialSplineValues>().radial = path;
  } else {
    values.field = {grin::GridValues::word};
    values.of<grin::GridValues>().grid = path;
    values.of<grin::GridValues>().grid_values = "excess";
  }
  const Keyed<grin::IndexFieldValues> keyed(values);
  return make_scene_field(keyed.keys, keyed.values, {.reach = 1});
}

SampledIndex sampled(const std::string& path, const std::string& dataset, std::int64_t nodes) {
  const grin::SceneField field = field_of(path, dataset);
  const grin::Box box = field.rim ? field.rim->bounds() : *field.grid;
  const auto count = static_cast<std::size_t>(nodes);
  SampledIndex found{{{count, count, count}, {}}, box.low, (box.high - box.low) / (nodes - 1)};
  const auto at = [&](std::size_t i, int axis) {
    return std::min(box.low[axis] + static_cast<double>(i) * found.spacing[axis], box.high[axis]);
  };
  for (std::size_t i = 0; i < count; ++i)
    for (std::size_t j = 0; j < count; ++j)
      for (std::size_t k = 0; k < count; ++k)
        found.index.values.push_back(index_at(field, {at(i, 0), at(j, 1), at(k, 2)}));
  return found;
}

NumberArray array_of(const ResultReader& file, const std::string& dataset) {
  if (file.stored_values(dataset) != StoredValues::real)
    throw InputError("export", dataset, "must have real numbers, to be written to such a file");
  return {file.shape(dataset), file.dataset<double>(dataset)};
}

/// Returns a dataset of two axes as a picture. Rows whose scale increases are in the order from the
/// bottom.
GreyPicture picture_of(const ResultReader& file, const std::string& dataset) {
  const NumberArray array = array_of(file, dataset);
  if (array.shape.size() != 2)
    throw InputError("export", dataset, "must have two axes, to be written as a picture");
  GreyPicture picture{array.shape[0], array.shape[1], array.values};
  const std::string scale = file.axes(dataset)[0];
  const auto heights = scale.empty() ? std::vector<double>() : file.dataset<double>(scale);
  if (heights.size() < 2 || heights.front() > heights.back()) return picture;
  for (std::size_t row = 0; row < picture.rows; ++row)
    std::copy_n(&array.values[(picture.rows - 1 - row) * picture.columns], picture.columns,
                &picture.values[row * picture.columns]);
  return picture;
}

/// Returns a dataset of two axes, or of three for several frames.
NumberArray frames_of(const ResultReader& file, const std::string& dataset) {
  NumberArray array = array_of(file, dataset);
  if ((array.shape.size() != 2 && array.shape.size() != 3) || array.values.empty())
    throw InputError("export", dataset, "must have two or three axes, to be written as frames");
  return array;
}

std::string text_of(const grin::Vec3& x) {
  return number_text({x[0], x[1], x[2]});
}

std::string export_field(const std::string& result, const std::string& dataset,
                         const std::filesystem::path& to, std::int64_t nodes) {
  const auto [index, origin, spacing] = sampled(result, dataset, nodes);
  if (to.extension() == ".vtk")
    write_vtk(to, "index", index, {origin[0], origin[1], origin[2]},
              {spacing[0], spacing[1], spacing[2]});
  else
    write_npy(to, index);
  return to.string() + ": index n at " + std::to_string(nodes) +
         "^3 points [x, y, z]; grid_values = "
         "index, grid_origin = " +
         text_of(origin) + ", grid_spacing = " + text_of(spacing);
}

}  // namespace

bool is_designed_field(const std::string& dataset) {
  return dataset == "ball_spline" || dataset == "radial_spline" || dataset == "excess";
}

std::string export_file(const std::filesystem::path& result, const std::string& dataset,
                        const std::filesystem::path& to, std::int64_t nodes) {
  const std::string ending = to.extension().string();
  const bool is_array = ending == ".npy" || ending == ".vtk";
  if (is_array && is_designed_field(dataset)) return export_field(result, dataset, to, nodes);
  const ResultReader file(result);
  if (ending == ".npy") {
    write_npy(to, array_of(file, dataset));
  } else if (ending == ".pfm") {
    write_pfm(to, picture_of(file, dataset));
  } else if (ending == ".png") {
    write_png(to, picture_of(file, dataset));
  } else if (ending == ".tif" || ending == ".tiff") {
    write_tiff(to, frames_of(file, dataset));
  } else if (ending == ".vtk") {
    throw InputError("to", to.string(),
                     "is for fields of design: ball_spline, radial_spline, excess");
  } else {
    throw InputError("to", to.string(), "must end with .npy, .pfm, .png, .tif, .tiff or .vtk");
  }
  return to.string() + ": " + dataset;
}

}  // namespace flatspeckle::apps
