#include "grin/render/pictures/map_datasets.h"

#include "core/result/result_group.h"
#include "grin/render/methods/tracer.h"
#include "grin/render/pictures/render_job.h"

namespace flatspeckle::grin {

std::vector<Complex> map_means(double samples, std::span<const Complex> sums, std::size_t cells) {
  std::vector<Complex> means;
  for (std::size_t i = 0; i < cells; ++i) means.push_back(sums[sums_per_cell * i] / samples);
  return means;
}

namespace {

std::vector<DatasetRow> rows_of_values(const std::string& axes) {
  return {{"map/fluence", Data::estimate, axes, "1/length^2",
           "fluence rate: radiance integrated over all directions, for the powers of the lights"},
          {"map/absorbed", Data::estimate, axes, "1/length^3", "absorbed power density"},
          {"map/label", Data::numbers, "", "1", "label of voxels"},
          {"map/label_absorbed", Data::estimate, "map/label", "1",
           "power absorbed within the map in voxels of each label"}};
}

std::vector<DatasetRow> operator+(std::vector<DatasetRow> rows,
                                  const std::vector<DatasetRow>& more) {
  rows.insert(rows.end(), more.begin(), more.end());
  return rows;
}

/// Returns the cells as rows and columns of a picture, with the last axis as columns.
PixelGrid rows_of(const LightMap& map) {
  const int columns = std::visit([](const auto& of) { return of.counts().back(); }, map);
  return {columns, cells(map) / columns};
}

Estimate every_second(const GroupedSums& sums, std::size_t first, const LightMap& map) {
  const auto count = static_cast<std::size_t>(cells(map));
  Estimate found = jackknife(sums, [=](double samples, std::span<const Complex> all) {
    return map_means(samples, all.subspan(first), count);
  });
  bound_errors(found, rows_of(map));
  return found;
}

void write_axes(const ResultGroup& root, const BoxCells& of) {
  root.put("map/x", of.centres(0));
  root.put("map/y", of.centres(1));
  root.put("map/z", of.centres(2));
}
void write_axes(const ResultGroup& root, const RingCells& of) {
  root.put("map/radius", of.radii());
  root.put("map/depth", of.depths());
}

}  // namespace

const DatasetTable box_map_table{
    "map of a box",
    std::vector<DatasetRow>{{"map/x", Data::scale, "", "length", "centre of the cell"},
                            {"map/y", Data::scale, "", "length", "centre of the cell"},
                            {"map/z", Data::scale, "", "length", "centre of the cell"}} +
        rows_of_values("map/x map/y map/z")};

const DatasetTable ring_map_table{
    "map of rings",
    std::vector<DatasetRow>{
        {"map/radius", Data::scale, "", "length", "mean of the inner and outer radius of the ring"},
        {"map/depth", Data::scale, "", "length", "middle of the ring along the axis"}} +
        rows_of_values("map/radius map/depth")};

Estimate fluence(const GroupedSums& sums, std::size_t first, const LightMap& map) {
  return every_second(sums, first, map);
}

Estimate absorbed(const GroupedSums& sums, std::size_t first, const LightMap& map) {
  return every_second(sums, first + 1, map);
}

std::optional<Estimate> absorbed_by_label(const RenderScene& scene, const RenderJob& job,
                                          const GroupedSums& sums) {
  const std::size_t labels = label_count(scene.stage);
  if (!scene.map || labels == 0) return std::nullopt;
  const std::size_t end = job.first_of_map() + map_sums(*scene.map, scene.stage);
  return jackknife(sums, EntryRange{end - labels, labels}, few_of_values);
}

void write_map(ResultFile& file, const RenderScene& scene, const RenderJob& job,
               const GroupedSums& sums) {
  const LightMap& map = *scene.map;
  const bool is_box = std::holds_alternative<BoxCells>(map);
  const ResultGroup root(file, is_box ? box_map_table : ring_map_table);
  std::visit([&](const auto& of) { write_axes(root, of); }, map);
  root.put("map/fluence", fluence(sums, job.first_of_map(), map));
  root.put("map/absorbed", absorbed(sums, job.first_of_map(), map));
  if (const auto powers = absorbed_by_label(scene, job, sums)) {
    root.number("map/label", powers->value.size());
    root.put("map/label_absorbed", *powers);
  }
}

}  // namespace flatspeckle::grin
