#include "grin/estimators/render_datasets.h"

#include "core/result/result_group.h"
#include "grin/rays/light_speed.h"

namespace flatspeckle::grin {

const DatasetTable render_table{
    .name = "render",
    .rows = {{"optical_path", Data::scale, "", "length", "middle of the bin of optical path"},
             {"time", Data::real, "optical_path", "s", "optical path over the speed of light"},
             {"transport/flights", Data::count, "", "1", "ways from one event to the next"},
             {"transport/lost_flights", Data::count, "", "1",
              "of these, too long, trapped or into an index that is not positive: they carry "
              "nothing on"},
             {"transport/joins", Data::count, "", "1",
              "vertices of light and sensor that were joined"},
             {"transport/lost_values", Data::count, "", "1",
              "contributions that were not finite, left out"}},
    .attributes = {{"", "length_unit", "float64", "metres in a unit of length, where given"}}};

namespace {

/// Mean over the pixels of each bin, times `factor`; one bin is all.
Estimate pixel_mean(const GroupedSums& sums, int pixels, int bins, double factor) {
  return jackknife(sums, [=](double samples, std::span<const Complex> all) {
    std::vector<Complex> means(bins);
    for (std::size_t i = 0; i < all.size(); ++i) means[i % bins] += all[i];
    for (Complex& mean : means) mean *= factor / (samples * pixels);
    return means;
  });
}

void write_bins(const ResultGroup& root, const TimeBins& bins,
                const std::optional<double>& length_unit) {
  std::vector<double> paths;
  for (int bin = 0; bin < bins.count; ++bin)
    paths.push_back(bins.first + (bins.last - bins.first) * (bin + 0.5) / bins.count);
  root.put("optical_path", paths);
  if (length_unit)
    root.put("time", column(paths, [&](double path) { return path * *length_unit / light_speed; }));
}

void write_counts(ResultFile& file, const RenderJob& job) {
  if (!job.counts) return;
  const ResultGroup root(file, render_table);
  root.put("transport/flights", job.counts->flights);
  root.put("transport/lost_flights", job.counts->lost_flights);
  root.put("transport/joins", job.counts->joins);
  root.put("transport/lost_values", job.counts->lost_values);
  if (!has_trials(job)) return;
  write_trials(file, job.counts->connections);
  write_pairs(file, job.counts->connections);
}

}  // namespace

RenderResult render_result(const RenderScene& scene, const RenderJob& job,
                           const GroupedSums& sums) {
  const double area = picture_of(scene.sensor).area();
  const bool is_area = std::holds_alternative<AreaDetector>(scene.sensor);
  const int pixels = job.pixels.count(), bins = job.bins.count;
  RenderResult result{rendered_picture(job, sums), pixel_mean(sums, pixels, 1, 1), {}, {}};
  if (is_area) result.total = pixel_mean(sums, pixels, 1, area);
  if (bins > 1) result.pulse = pixel_mean(sums, pixels, bins, is_area ? area : 1);
  return result;
}

void write_render(ResultFile& file, const RenderScene& scene, const RenderJob& job,
                  const RenderResult& result, const std::optional<double>& length_unit) {
  const ResultGroup root(file, render_table), sensor(file, table_of(scene.sensor));
  const PixelRectangle pixels = picture_of(scene.sensor);
  if (length_unit) root.attribute("length_unit", *length_unit);
  sensor.put("row", pixels.row_centres());
  sensor.put("column", pixels.column_centres());
  sensor.put("image", result.picture.steady);
  sensor.put("mean", result.mean);
  if (result.total) sensor.put("total", *result.total);
  if (job.bins.count > 1) {
    write_bins(root, job.bins, length_unit);
    sensor.put("transient", result.picture.bins);
    sensor.put("pulse", result.pulse);
  }
  write_counts(file, job);
}

bool has_trials(const RenderJob& job) {
  return job.counts && job.counts->connections.pairs > 0;
}

}  // namespace flatspeckle::grin
