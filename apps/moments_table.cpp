#include "apps/moments_table.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace flatspeckle::apps {

std::string shown_value(Complex value) {
  char text[48];
  if (std::abs(value.imag()) < 5e-7 * std::abs(value))
    std::snprintf(text, sizeof text, "%.5g", value.real());
  else
    std::snprintf(text, sizeof text, "%.5g%+.4gi", value.real(), value.imag());
  return text;
}

std::string shown_channel(const CovarianceRequest& request, std::uint32_t channel) {
  char text[48];
  const auto [light, view] = request.channels[channel];
  const View& seen = request.views[view];
  if (seen.near)
    std::snprintf(text, sizeof text, "%8.4f sensor %-3u", request.lights[light], view);
  else
    std::snprintf(text, sizeof text, "%8.4f %8.4f", request.lights[light], seen.angle);
  return text;
}

std::size_t shown_entries(const CovarianceRequest& request) {
  if (request.kind == CovarianceRequest::Kind::memory_effect) return request.reference_intensity(0);
  return request.entries.size();
}

void print_entries(const CovarianceRequest& request, const Estimate& covariance) {
  const std::size_t entries = shown_entries(request);
  std::printf("%-17s %-17s  %21s %9s\n", "light 1  view 1", "light 2  view 2", "covariance",
              "error");
  for (std::size_t e = 0; e < std::min(entries, most_rows); ++e) {
    const auto [a, b] = request.entries[e];
    std::printf("%s %s  %21s %9.2g\n", shown_channel(request, a).c_str(),
                shown_channel(request, b).c_str(), shown_value(covariance.value[e]).c_str(),
                covariance.error[e]);
  }
  if (entries > most_rows) std::printf("... and %zu more\n", entries - most_rows);
}

}  // namespace flatspeckle::apps
