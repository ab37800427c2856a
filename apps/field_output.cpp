#include "apps/field_output.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string>

#include "apps/estimate_output.h"
#include "apps/moments_output.h"
#include "mc/speckle/field_statistics.h"

namespace flatspeckle::apps {

namespace {

using Axes = std::vector<Axis>;

std::vector<double> steps(std::size_t n, double step) {
  std::vector<double> numbers(n);
  for (std::size_t i = 0; i < n; ++i) numbers[i] = step * static_cast<double>(i);
  return numbers;
}

std::vector<double> real_parts(const std::vector<Complex>& values) {
  std::vector<double> real;
  for (Complex value : values) real.push_back(value.real());
  return real;
}

std::string view_axis(const Scene& scene) {
  return scene.request.views.front().near ? "sensor" : "view_angle";
}

void write_field_axes(ResultFile& file, const Scene& scene, const std::vector<double>& tilts,
                      std::size_t realizations) {
  const auto lights = scene.request.lights.angles();
  file.scale("realization", steps(realizations, 1), "1", "number of the field");
  file.scale("light_angle", lights, "rad", "direction of the light, from +z towards +x");
  write_view_axis(file, scene.request.views);
  if (tilts.empty()) return;
  std::vector<double> q;
  for (std::size_t t = 0; t < tilts.size(); ++t)
    q.push_back(scene.k * (std::sin(lights[t]) - std::sin(lights[t] - tilts[t])));
  file.dataset("tilt", tilts, {"light_angle"}, "rad", "rotation of the light");
  file.dataset("tilt_q", q, {"light_angle"}, "1/length", "transverse wavenumber of the tilt");
}

/// In chunks of about a mebibyte.
void write_field(ResultFile& file, const Scene& scene, const DrawnFields& drawn) {
  const std::size_t lights = scene.request.lights.size(), views = scene.request.views.size(),
                    channels = lights * views, realizations = drawn.field.size() / channels;
  constexpr std::size_t chunk_values = std::size_t{1} << 16;
  const std::size_t at_once = std::clamp<std::size_t>(chunk_values / channels, 1, realizations),
                    chunk_lights = std::clamp<std::size_t>(chunk_values / views, 1, lights);
  const bool far_field = !scene.request.views.front().near;
  file.begin_dataset("field", {"realization", "light_angle", view_axis(scene)},
                     {at_once, chunk_lights, std::min(views, chunk_values)},
                     far_field ? "length^(1/2)" : "1", "speckle field without its mean");
  for (std::size_t first = 0; first < realizations; first += at_once) {
    const std::size_t count = std::min(at_once, realizations - first);
    file.write_block("field", std::span(drawn.field).subspan(first * channels, count * channels),
                     {first, 0, 0}, {count, lights, views});
  }
  const mc::FieldPlan& plan = drawn.plan;
  const bool by_paths = plan.method == mc::FieldMethod::paths;
  file.attribute("field", "method", std::string(by_paths ? "paths" : "covariance"));
  if (by_paths) {
    file.attribute("field", "paths_per_field", plan.paths_per_field);
    file.attribute("field", "excess_kurtosis", plan.excess);
  } else {
    file.attribute("field", "covariance_paths", plan.covariance_paths);
  }
  file.attribute("field", "paths_cost", plan.paths_cost);
  if (std::isfinite(plan.covariance_cost))
    file.attribute("field", "covariance_cost", plan.covariance_cost);
}

/// Counts, in bins [intensity_bin, intensity_bin + 1/4) of |u|^2 / <|u|^2>; the last one is open.
void write_histogram(ResultFile& file, const mc::FieldStatistics& statistics) {
  const double values = statistics.values();
  Estimate counts = statistics.histogram();
  for (Complex& count : counts.value) count *= values;
  for (double& error : counts.error) error *= values;
  std::vector<double> expected = mc::FieldStatistics::exponential_law();
  for (double& count : expected) count *= values;
  file.scale("intensity_bin", steps(mc::FieldStatistics::bins, mc::FieldStatistics::bin_width), "1",
             "lower edge of a bin of intensity over its mean; the last bin is open");
  write_estimate(file, "histogram", counts, {"intensity_bin"}, "1", "values in the bin");
  file.dataset("histogram_expected", expected, {"intensity_bin"}, "1",
               "values in the bin by the exponential law");
}

void write_autocorrelation(ResultFile& file, const Scene& scene, double step,
                           const mc::FieldStatistics& statistics, const DrawnFields& drawn) {
  const Estimate& siegert = drawn.siegert;
  const bool near = scene.request.views.front().near;
  file.scale("view_lag", steps(scene.request.views.size(), step), near ? "length" : "1",
             near ? "distance of two sensors" : "difference of the sines of two views");
  const Estimate found = statistics.autocorrelation();
  write_estimate(file, "intensity_autocorrelation", found, {"view_lag"}, "1",
                 "<I I'> / (<I> <I'>) - 1 over the first light's views");
  if (siegert.value.empty()) return;
  write_estimate(file, "siegert", siegert, {"view_lag"}, "1",
                 "|<u u'*>|^2 / (<I> <I'>) over the same views, from light paths");
  const bool by_paths = drawn.plan.method == mc::FieldMethod::paths;
  const double excess = by_paths ? drawn.plan.excess : 0;
  double deviation = 0;
  for (std::size_t d = 0; d < found.value.size(); ++d) {
    const double beyond = std::abs(found.value[d] - siegert.value[d]) - excess;
    const double error = std::hypot(found.error[d], siegert.error[d]);
    if (beyond > 0 && error > 0) deviation = std::max(deviation, beyond / error);
  }
  std::printf(
      "autocorrelation of the intensity: Siegert's relation within %.1f standard errors%s\n",
      deviation, by_paths ? " and the excess kurtosis" : "");
}

}  // namespace

void write_fields(ResultFile& file, const Scene& scene, const std::vector<double>& tilts,
                  const DrawnFields& drawn) {
  const std::size_t channels = scene.request.channels.size(), views = scene.request.views.size();
  const auto step = mc::equal_step(scene.request.views);
  mc::FieldStatistics statistics(real_parts(drawn.intensity.value), views, step.has_value());
  for (std::size_t first = 0; first < drawn.field.size(); first += channels)
    statistics.add(std::span(drawn.field).subspan(first, channels));

  write_field_axes(file, scene, tilts, drawn.field.size() / channels);
  write_field(file, scene, drawn);
  const Axes axes = {"light_angle", view_axis(scene)};
  write_estimate(file, "intensity", drawn.intensity, axes,
                 scene.request.views.front().near ? "1" : "length", "variance of the field");
  write_estimate(file, "contrast", statistics.contrast(), axes, "1",
                 "standard deviation over mean of the intensity");
  const Estimate contrast = statistics.mean_contrast(), circularity = statistics.circularity();
  write_estimate(file, "mean_contrast", contrast, {}, "1", "contrast of I / <I> over all channels");
  file.dataset("circularity", circularity.value, {}, "1", "<u u> / <I> over all channels");
  file.dataset("circularity_error", circularity.error, {}, "1",
               "standard error: <u u> / <I> over all channels");
  std::printf("contrast %.4f +- %.2g, |<u u>| / <I> %.2g +- %.2g (Gaussian: 1 and 0)\n",
              contrast.value[0].real(), contrast.error[0], std::abs(circularity.value[0]),
              circularity.error[0]);
  write_histogram(file, statistics);
  if (step) write_autocorrelation(file, scene, *step, statistics, drawn);
}

}  // namespace flatspeckle::apps
