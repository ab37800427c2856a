#include "apps/results/exported_file.h"

#include <algorithm>
#include <complex>
#include <utility>

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

/// A dataset, or the part of it at chosen indices of some axes: its numbers, and the names of the
/// scales of its axes.
struct ChosenPart {
  NumberArray array;
  std::vector<std::string> axes;
};

/// Reduces an axis to the element `index`.
void choose(ChosenPart& part, std::size_t axis, std::size_t index) {
  auto& [shape, values, is_complex] = part.array;
  std::size_t after = is_complex ? 2 : 1;
  for (std::size_t i = axis + 1; i < shape.size(); ++i) after *= shape[i];
  const std::size_t extent = shape[axis], before = values.size() / (extent * after);
  for (std::size_t i = 0; i < before; ++i)
    std::copy_n(values.begin() + static_cast<long>((i * extent + index) * after), after,
                values.begin() + static_cast<long>(i * after));
  values.resize(before * after);
  shape.erase(shape.begin() + static_cast<long>(axis));
  part.axes.erase(part.axes.begin() + static_cast<long>(axis));
}

/// Reduces the axis that `text` names, as in realization=0, to the element it gives.
void choose(ChosenPart& part, const std::string& text) {
  const std::size_t equals = std::min(text.find('='), text.size());
  const auto axis = std::ranges::find(part.axes, text.substr(0, equals));
  if (axis == part.axes.end())
    throw InputError("select", text,
                     "must be AXIS=INDEX with an axis among " + join_texts(part.axes, " "));
  const auto number = static_cast<std::size_t>(axis - part.axes.begin());
  const std::size_t extent = part.array.shape[number];
  const auto index = read_whole_number(text.substr(std::min(equals + 1, text.size())));
  if (!index || *index < 0 || static_cast<std::size_t>(*index) >= extent)
    throw InputError("select", text, "must have an index from 0 to " + std::to_string(extent - 1));
  choose(part, number, static_cast<std::size_t>(*index));
}

ChosenPart part_of(const ResultReader& file, const std::string& dataset,
                   const std::vector<std::string>& select) {
  ChosenPart part{{file.shape(dataset), {}}, file.axes(dataset)};
  if (file.stored_values(dataset) == StoredValues::text)
    throw InputError("export", dataset, "must have numbers, to be written to such a file");
  if (file.stored_values(dataset) == StoredValues::complex) {
    part.array.is_complex = true;
    for (const Complex value : file.dataset<Complex>(dataset)) {
      part.array.values.push_back(value.real());
      part.array.values.push_back(value.imag());
    }
  } else {
    part.array.values = file.dataset<double>(dataset);
  }
  for (const std::string& text : select) choose(part, text);
  return part;
}

/// Replaces complex numbers by their squared magnitudes.
void take_intensities(NumberArray& array) {
  if (!array.is_complex) return;
  for (std::size_t i = 0; 2 * i < array.values.size(); ++i)
    array.values[i] = std::norm(Complex(array.values[2 * i], array.values[2 * i + 1]));
  array.values.resize(array.values.size() / 2);
  array.is_complex = false;
}

/// Throws InputError if the number of axes is not accepted.
void require_axes(const std::string& dataset, const ChosenPart& part, bool accepted,
                  const std::string& what) {
  if (accepted && !part.array.values.empty()) return;
  throw InputError("export", dataset,
                   "must have " + what + "; it has " + join_texts(part.axes, " ") +
                       ": choose an element of an axis with --select AXIS=INDEX");
}

/// Returns a dataset of two axes as a picture. Rows whose scale increases are in the order from the
/// bottom.
GreyPicture picture_of(const ResultReader& file, const std::string& dataset, ChosenPart part) {
  NumberArray& array = part.array;
  require_axes(dataset, part, array.shape.size() == 2, "two axes, to be written as a picture");
  take_intensities(array);
  GreyPicture picture{array.shape[0], array.shape[1], array.values};
  const std::string scale = part.axes[0];
  const auto heights = scale.empty() ? std::vector<double>() : file.dataset<double>(scale);
  if (heights.size() < 2 || heights.front() > heights.back()) return picture;
  for (std::size_t row = 0; row < picture.rows; ++row)
    std::copy_n(&array.values[(picture.rows - 1 - row) * picture.columns], picture.columns,
                &picture.values[row * picture.columns]);
  return picture;
}

/// Returns a dataset of two axes, or of three for several frames.
NumberArray frames_of(const std::string& dataset, ChosenPart part) {
  const std::size_t axes = part.array.shape.size();
  require_axes(dataset, part, axes == 2 || axes == 3, "two or three axes, to be written as frames");
  take_intensities(part.array);
  return std::move(part.array);
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

/// Writes a picture for display, or one with its rows in the order of the file for other programs.
/// Returns a description of its pixels.
std::string export_png(const ResultReader& file, const std::string& dataset, ChosenPart part,
                       const std::filesystem::path& to, const ExportFormat& format) {
  if (!format.linear)
    return write_display_png(to, picture_of(file, dataset, std::move(part))) +
           "; for numbers add --linear, or write .tif or .npy";
  require_axes(dataset, part, part.array.shape.size() == 2, "two axes, to be written as a picture");
  take_intensities(part.array);
  return write_linear_png(to, {part.array.shape[0], part.array.shape[1], part.array.values});
}

}  // namespace

bool is_designed_field(const std::string& dataset) {
  return dataset == "ball_spline" || dataset == "radial_spline" || dataset == "excess";
}

std::string export_file(const std::filesystem::path& result, const std::string& dataset,
                        const std::filesystem::path& to, const ExportFormat& format) {
  const std::string ending = to.extension().string();
  const bool is_array = ending == ".npy" || ending == ".vtk";
  if (is_array && is_designed_field(dataset))
    return export_field(result, dataset, to, format.nodes);
  if (ending == ".vtk")
    throw InputError("to", to.string(),
                     "is for fields of design: ball_spline, radial_spline, excess");
  const ResultReader file(result);
  const auto part = [&] { return part_of(file, dataset, format.select); };
  if (ending == ".npy")
    write_npy(to, part().array);
  else if (ending == ".pfm")
    write_pfm(to, picture_of(file, dataset, part()));
  else if (ending == ".exr")
    write_exr(to, picture_of(file, dataset, part()));
  else if (ending == ".png")
    return to.string() + ": " + dataset + ", " + export_png(file, dataset, part(), to, format);
  else if (ending == ".tif" || ending == ".tiff")
    write_tiff(to, frames_of(dataset, part()));
  else
    throw InputError("to", to.string(),
                     "must end with .npy, .pfm, .exr, .png, .tif, .tiff or .vtk");
  return to.string() + ": " + dataset;
}

}  // namespace flatspeckle::apps
