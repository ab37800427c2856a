#include "apps/extras_table.h"

#include <algorithm>
#include <cstdio>

#include "apps/moments_table.h"

namespace flatspeckle::apps {

void print_gradient(const CovarianceRequest& request, const mc::GradientJob& job,
                    const mc::GradientEstimates& gradient) {
  const auto& names = job.parameters;
  const std::size_t entries = gradient.entries.value.size() / names.size();
  for (std::size_t p = 0; p < names.size(); ++p)
    print_entries(request, part(gradient.entries, p * entries, entries), "d/d " + names[p]);
  const Estimate& range = gradient.effect.range;
  if (std::ranges::all_of(range.value, [](Complex slope) { return slope == 0.0; })) return;
  for (std::size_t p = 0; p < names.size(); ++p)
    std::printf("d/d %-13s of the range q L at C_I = 1/2: %11.5g +- %.2g\n", names[p].c_str(),
                range.value[p].real(), range.error[p]);
}

void print_delays(const CovarianceRequest& request, const std::vector<double>& delays,
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

}  // namespace flatspeckle::apps
