#include "apps/render_output.h"

#include <algorithm>
#include <cstdio>
#include <string>

#include "apps/estimate_output.h"
#include "apps/trials_output.h"
#include "grin/rays/light_speed.h"

namespace flatspeckle::apps {

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

class Writer {
 public:
  Writer(ResultFile& file, const grin::RenderScene& scene)
      : file_(file), axes_(axes_of(scene.sensor)) {
    file.scale("row", axes_.row, axes_.units, axes_.row_name);
    file.scale("column", axes_.column, axes_.units, axes_.column_name);
  }

  void estimate(const std::string& name, const Estimate& estimate, const std::vector<Axis>& axes,
                const std::string& units, const std::string& long_name) {
    write_estimate(file_, name, estimate, axes, units, long_name);
  }

  void steady(const RenderResult& result) {
    estimate("image", result.picture.steady, {"row", "column"}, axes_.image_units,
             axes_.image_name);
    estimate("mean", result.mean, {}, axes_.image_units, "mean over the pixels");
    if (result.total) estimate("total", *result.total, {}, "1", "power on the detector");
  }

  void timed(const RenderResult& result, const grin::TimeBins& bins,
             const std::optional<double>& length_unit) {
    std::vector<double> paths, times;
    for (int bin = 0; bin < bins.count; ++bin)
      paths.push_back(bins.first + (bins.last - bins.first) * (bin + 0.5) / bins.count);
    file_.scale("optical_path", paths, "length", "middle of the bin of optical path");
    for (double path : paths) times.push_back(path * length_unit.value_or(0) / grin::light_speed);
    if (length_unit)
      file_.dataset("time", times, {"optical_path"}, "s", "optical path over the speed of light");
    estimate("transient", result.picture.bins, {"row", "column", "optical_path"}, axes_.image_units,
             axes_.image_name + std::string(", in the bin"));
    estimate(
        "pulse", result.pulse, {"optical_path"}, result.total ? "1" : axes_.image_units,
        result.total ? "power on the detector, in the bin" : "mean over the pixels, in the bin");
  }

 private:
  ResultFile& file_;
  grin::SensorAxes axes_;
};

void write_counts(ResultFile& file, const grin::TransportCounts& counts) {
  const auto count = [&](const char* name, std::uint64_t value, const std::string& long_name) {
    file.dataset(std::string("transport/") + name, std::vector<std::uint64_t>{value}, {}, "1",
                 long_name);
  };
  count("flights", counts.flights, "ways from one event to the next");
  count("lost_flights", counts.lost_flights,
        "of these, too long, trapped or into an index that is not positive: they carry nothing on");
  count("joins", counts.joins, "vertices of light and sensor that were joined");
  count("lost_values", counts.lost_values, "contributions that were not finite, left out");
}

/// What is missing from a picture is not passed over in silence.
void note_losses(const grin::TransportCounts& counts) {
  if (counts.lost_flights > 0)
    std::fprintf(
        stderr,
        "note: %.2g %% of the flights were longer than max_length, trapped in a body, or came to "
        "where the index is not positive; their light is missing\n",
        100 * static_cast<double>(counts.lost_flights) / static_cast<double>(counts.flights));
  if (counts.lost_values > 0)
    std::fprintf(stderr, "note: %llu contributions were not finite and are left out\n",
                 static_cast<unsigned long long>(counts.lost_values));
}

/// A dark picture is more often a mistake than a result.
void note_darkness(const grin::Stage& stage) {
  std::fputs("note: no light came to the sensor\n", stderr);
  if (stage.body)
    std::fputs(
        "note: points are not joined across the surface of a body: a pinhole does not see a point "
        "or beam through it, a camera with a lens or an area sensor does\n",
        stderr);
}

bool has_trials(const grin::RenderJob& job) {
  return job.counts && job.counts->connections.pairs > 0;
}

void print_row(const char* name, const Estimate& estimate, std::size_t entry,
               const std::string& units) {
  std::printf("%-16s %-13.6g %-10.2g %s\n", name, estimate.value[entry].real(),
              estimate.error[entry], units.c_str());
}

}  // namespace

RenderResult render_result(const grin::RenderScene& scene, const grin::RenderJob& job,
                           const GroupedSums& sums) {
  const grin::SensorAxes axes = axes_of(scene.sensor);
  const int pixels = job.pixels.count(), bins = job.bins.count;
  RenderResult result{rendered_picture(job, sums), pixel_mean(sums, pixels, 1, 1), {}, {}};
  if (axes.area) result.total = pixel_mean(sums, pixels, 1, *axes.area);
  if (bins > 1) result.pulse = pixel_mean(sums, pixels, bins, axes.area.value_or(1));
  return result;
}

void write_render(ResultFile& file, const grin::RenderScene& scene, const grin::RenderJob& job,
                  const RenderResult& result, const std::optional<double>& length_unit) {
  if (length_unit) file.attribute("/", "length_unit", *length_unit);
  Writer writer(file, scene);
  writer.steady(result);
  if (job.bins.count > 1) writer.timed(result, job.bins, length_unit);
  if (job.counts) write_counts(file, *job.counts);
  if (!has_trials(job)) return;
  write_trials(file, job.counts->connections);
  write_pairs(file, job.counts->connections);
}

void print_render(const grin::RenderScene& scene, const grin::RenderJob& job,
                  const RenderResult& result) {
  const grin::SensorAxes axes = axes_of(scene.sensor);
  const auto& image = result.picture.steady;
  const auto brightest =
      std::max_element(image.value.begin(), image.value.end(),
                       [](const Complex& a, const Complex& b) { return a.real() < b.real(); });
  std::printf("%-16s %-13s %-10s\n", "", "value", "error");
  if (result.total) print_row("total power", *result.total, 0, "");
  print_row("mean of pixels", result.mean, 0, axes.image_units);
  print_row("brightest pixel", image, static_cast<std::size_t>(brightest - image.value.begin()),
            axes.image_units);
  if (brightest->real() > 0)
    std::printf("pixels: relative error %.2g %%\n", 100 * relative_error(image));
  else
    note_darkness(scene.stage);
  if (job.counts) note_losses(*job.counts);
  if (!has_trials(job)) return;
  const auto& curves = job.counts->connections;
  std::printf("curves: %llu pairs, %.3g %% of trials converged, %.3g further trials each\n",
              static_cast<unsigned long long>(curves.pairs), 100 * curves.success_rate(),
              curves.mean_refind());
}

}  // namespace flatspeckle::apps
