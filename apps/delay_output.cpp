#include "apps/delay_output.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "apps/estimate_output.h"
#include "apps/moments_output.h"
#include "apps/moments_table.h"

namespace flatspeckle::apps {

namespace {

void print_correlation(const CovarianceRequest& request, const std::vector<double>& delays,
                       const Estimate& correlation) {
  std::printf("%-17s %10s %12s %9s\n", "light    view", "delay", "correlation", "error");
  const std::size_t channels = request.channels.size(), rows = channels * delays.size();
  for (std::size_t row = 0; row < std::min(rows, most_rows); ++row) {
    const std::size_t c = row / delays.size(), t = row % delays.size(), i = t * channels + c;
    std::printf("%s %10.4g %12.5g %9.2g\n",
                shown_channel(request, static_cast<std::uint32_t>(c)).c_str(), delays[t],
                correlation.value[i].real(), correlation.error[i]);
  }
  if (rows > most_rows) std::printf("... and %zu more\n", rows - most_rows);
}

bool through_slab(const Scene& scene) {
  const auto& views = scene.request.views;
  return scene.domain.kind == Domain::Kind::slab &&
         std::all_of(views.begin(), views.end(),
                     [](const View& view) { return std::cos(view.angle) > 0; });
}

}  // namespace

void write_delays(ResultFile& file, const Scene& scene, const mc::DelayJob& job,
                  const std::vector<double>& delays, const GroupedSums& sums) {
  const Estimate correlation = jackknife(sums, job.correlation);
  print_correlation(scene.request, delays, correlation);
  file.scale("delay", delays, "1", "k^2 D tau");
  const std::vector<Axis> axes = {"delay", "light_angle", view_axis(scene.request)};
  write_estimate(file, "covariance", jackknife(sums, job.covariance), axes, covariance_units(scene),
                 "covariance of the field with itself after a delay");
  write_estimate(file, "field_correlation", correlation, axes, "1",
                 "field correlation after a delay");
  if (!through_slab(scene)) return;
  std::vector<double> theory;
  for (const double delay : delays)
    theory.push_back(mc::diffusion_delay_correlation(scene.medium, scene.domain.depth, delay));
  file.dataset("diffusion_theory", theory, {"delay"}, "1",
               "field correlation of transmitted light in diffusion theory");
}

}  // namespace flatspeckle::apps
