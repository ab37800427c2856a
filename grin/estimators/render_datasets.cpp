#include "grin/estimators/render_datasets.h"

#include "core/result/result_group.h"
#include "grin/estimators/picture_errors.h"
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

/// The pixels of one sensor among all, and its bins.
struct Pixels {
  PixelGrid grid;
  std::size_t first, bins;
  std::size_t count() const { return static_cast<std::size_t>(grid.count()); }
};

/// Of as many entries per pixel.
Estimate own_part(const Estimate& all, const Pixels& pixels, std::size_t per_pixel) {
  Estimate own = part(all, pixels.first * per_pixel, pixels.count() * per_pixel);
  bound_errors(own, pixels.grid);
  return own;
}

/// Mean over the pixels, times `factor`, in so many bins: one, or those of the pixels.
Estimate pixel_mean(const GroupedSums& sums, const Pixels& pixels, std::size_t bins,
                    double factor) {
  Estimate mean = jackknife(sums, [=](double samples, std::span<const Complex> all) {
    std::vector<Complex> means(bins);
    const auto own = all.subspan(pixels.first * pixels.bins, pixels.count() * pixels.bins);
    for (std::size_t i = 0; i < own.size(); ++i) means[i % bins] += own[i];
    for (Complex& mean : means) mean *= factor / (samples * static_cast<double>(pixels.count()));
    return means;
  });
  bound_errors(mean, {1, 1});
  return mean;
}

SensorResult sensor_result(const Sensor& sensor, const Pixels& pixels, const RenderedPicture& all,
                           const GroupedSums& sums) {
  const double area = picture_of(sensor).area();
  const bool is_area = std::holds_alternative<AreaDetector>(sensor);
  SensorResult result{{own_part(all.bins, pixels, pixels.bins), own_part(all.steady, pixels, 1)},
                      pixel_mean(sums, pixels, 1, 1),
                      {},
                      {}};
  if (is_area) result.total = pixel_mean(sums, pixels, 1, area);
  if (pixels.bins > 1) result.pulse = pixel_mean(sums, pixels, pixels.bins, is_area ? area : 1);
  return result;
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

void write_sensor(const ResultGroup& group, const PixelRectangle& pixels,
                  const SensorResult& result) {
  group.put("row", pixels.row_centres());
  group.put("column", pixels.column_centres());
  group.put("image", result.picture.steady);
  group.put("mean", result.mean);
  if (result.total) group.put("total", *result.total);
  if (result.pulse.value.empty()) return;
  group.put("transient", result.picture.bins);
  group.put("pulse", result.pulse);
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
  const RenderedPicture all = rendered_picture(job, sums);
  const auto bins = static_cast<std::size_t>(job.bins.count);
  RenderResult result;
  std::size_t first = 0;
  for (const Sensor& sensor : scene.sensors) {
    const Pixels pixels{picture_of(sensor).grid(), first, bins};
    result.push_back(sensor_result(sensor, pixels, all, sums));
    first += pixels.count();
  }
  return result;
}

void write_render(ResultFile& file, const RenderScene& scene, const RenderJob& job,
                  const RenderResult& result, const std::optional<double>& length_unit) {
  const ResultGroup root(file, render_table);
  if (length_unit) root.attribute("length_unit", *length_unit);
  if (job.bins.count > 1) write_bins(root, job.bins, length_unit);
  for (std::size_t i = 0; i < result.size(); ++i)
    write_sensor({file, table_of(scene.sensors[i]),
                  result.size() > 1 ? "sensors/" + sensor_name(scene, i) : ""},
                 picture_of(scene.sensors[i]), result[i]);
  write_counts(file, job);
}

bool has_trials(const RenderJob& job) {
  return job.counts && job.counts->connections.pairs > 0;
}

}  // namespace flatspeckle::grin
