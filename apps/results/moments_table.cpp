#include "apps/results/moments_table.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numbers>

#include "mc/slab/refinement.h"

namespace flatspeckle::apps {

std::string shown_value(Complex value) {
  char text[48];
  if (std::abs(value.imag()) < 5e-7 * std::abs(value))
    std::snprintf(text, sizeof text, "%.5g", value.real());
  else
    std::snprintf(text, sizeof text, "%.5g%+.4gi", value.real(), value.imag());
  return text;
}

namespace {

/// Whether some direction is not in the plane of x and z, so that azimuths are shown.
bool has_azimuths(const CovarianceRequest& request) {
  const auto turned = [](const auto& one) { return one.azimuth != 0; };
  return std::ranges::any_of(request.lights, turned) || std::ranges::any_of(request.views, turned);
}

/// Writes an angle or, if `both`, angle and azimuth.
template <std::size_t size>
void show_direction(char (&text)[size], double angle, double azimuth, bool both) {
  if (both)
    std::snprintf(text, size, "(%.5g, %.5g)", angle, azimuth);
  else
    std::snprintf(text, size, "%8.6g", angle);
}

}  // namespace

std::string shown_channel(const CovarianceRequest& request, std::uint32_t channel) {
  char light_text[40], view_text[40];
  const bool azimuths = has_azimuths(request);
  const auto [light, view] = request.channels[channel];
  const Light& lit = request.lights[light];
  const View& seen = request.views[view];
  if (lit.kind == Light::Kind::plane)
    show_direction(light_text, lit.angle, lit.azimuth, azimuths);
  else
    std::snprintf(light_text, sizeof light_text, "light %-3u", light);
  if (seen.near && request.has_reference())
    std::snprintf(view_text, sizeof view_text, "x %-8.5g", seen.point.x);
  else if (seen.near)
    std::snprintf(view_text, sizeof view_text, "sensor %-3u", view);
  else
    show_direction(view_text, seen.angle, seen.azimuth, azimuths);
  return std::string(light_text) + ' ' + view_text;
}

std::size_t shown_entries(const CovarianceRequest& request) {
  if (request.has_reference()) return request.reference_intensity(0);
  return request.entries.size();
}

void print_entries(const CovarianceRequest& request, const Estimate& estimate,
                   const std::string& name) {
  const std::size_t entries = shown_entries(request);
  std::printf("%-17s %-17s  %21s %9s\n", "light 1  view 1", "light 2  view 2", name.c_str(),
              "error");
  for (std::size_t e = 0; e < std::min(entries, most_rows); ++e) {
    const auto [a, b] = request.entries[e];
    std::printf("%s %s  %21s %9.2g\n", shown_channel(request, a).c_str(),
                shown_channel(request, b).c_str(), shown_value(estimate.value[e]).c_str(),
                estimate.error[e]);
  }
  if (entries > most_rows) std::printf("... and %zu more\n", entries - most_rows);
}

void print_errors(const CovarianceRequest& request, const Estimate& estimate) {
  if (estimate.value.size() < 2) return;
  const auto scale = mc::scales(request.entries, estimate.value);
  std::size_t worst = 0;
  const auto size = [&](std::size_t e) { return scale[e] > 0 ? estimate.error[e] / scale[e] : 0; };
  for (std::size_t e = 0; e < scale.size(); ++e)
    if (size(e) > size(worst)) worst = e;
  const auto [a, b] = request.entries[worst];
  std::printf("errors: RMS %.2g %% of the RMS value; largest of one entry %.2g %%: %s %s\n",
              100 * relative_error(estimate), 100 * size(worst), shown_channel(request, a).c_str(),
              a == b ? "" : shown_channel(request, b).c_str());
}

namespace {

/// Prints memory-effect ranges. group: group of the result file that contains them; empty for the
/// root.
void print_ranges_of(const std::string& group, const std::vector<mc::WrittenRange>& ranges) {
  for (const auto& [long_name, estimate, few_steps, is_angle] : ranges) {
    if (few_steps)
      std::fputs(
          "note: a range is interpolated with fewer than four points below it; its error excludes "
          "the interpolation error: add points\n",
          stderr);
    std::printf("%s%s%s: %s", group.c_str(), group.empty() ? "" : "/", long_name.c_str(),
                range_text(estimate.range, estimate.error).c_str());
    if (is_angle)
      std::printf(" rad = %.4g mrad = %.4g deg", 1e3 * estimate.range.value,
                  180 / std::numbers::pi * estimate.range.value);
    std::printf("\n");
  }
}

/// Prints the correlations C_E and C_I of a curve, then its memory-effect ranges.
void print_curve(const CovarianceRequest& request, const mc::WrittenMoves& moves) {
  const bool tilts = request.kind == CovarianceRequest::Kind::memory_effect;
  if (tilts || request.kind == CovarianceRequest::Kind::translation) {
    const auto& [value, error, rare] = moves.correlation;
    std::printf("%-11s %11s %9s %11s %9s\n", tilts ? "tilt" : "translation", "C_E", "error", "C_I",
                "error");
    for (std::size_t m = 0; m < std::min(value.size(), most_rows); ++m) {
      const double field = std::abs(value[m]);
      std::printf("%-11.6g %11.5g %9.2g %11.5g %9.2g\n",
                  (tilts ? request.tilts : request.shifts)[m], field, error[m], field * field,
                  2 * field * error[m]);
    }
    if (value.size() > most_rows) std::printf("... and %zu more\n", value.size() - most_rows);
  }
  print_ranges_of("", moves.ranges);
}

}  // namespace

void print_ranges(const std::string& group, const std::vector<mc::WrittenMoves>& groups) {
  for (const mc::WrittenMoves& moves : groups) print_ranges_of(group, moves.ranges);
}

void print_moves(const CovarianceRequest& request, const std::vector<mc::WrittenMoves>& groups) {
  for (const mc::WrittenMoves& moves : groups) {
    if (groups.size() > 1)
      std::printf("%s views:\n", &moves == &groups.front() ? "transmitted" : "reflected");
    print_curve(request, moves);
  }
}

std::string range_text(const mc::Range& range, double error) {
  using Censoring = mc::Range::Censoring;
  char text[64];
  if (range.censored == Censoring::above_value)
    std::snprintf(text, sizeof text, "above %.4g, the largest step", range.value);
  else if (range.censored == Censoring::below_value)
    std::snprintf(text, sizeof text, "below %.4g, the smallest step", range.value);
  else
    std::snprintf(text, sizeof text, "%.4g +- %.2g", range.value, error);
  return text;
}

void print_gradient(const CovarianceRequest& request, const mc::GradientJob& job,
                    const mc::GradientEstimates& gradient) {
  const auto& names = job.parameters;
  const std::size_t entries = gradient.entries.value.size() / names.size();
  for (std::size_t p = 0; p < names.size(); ++p)
    print_entries(request, part(gradient.entries, p * entries, entries), "d/d " + names[p]);
  const Estimate& range = gradient.effect.range;
  if (std::ranges::all_of(range.value, [](Complex derivative) { return derivative == 0.0; }))
    return;
  for (std::size_t p = 0; p < names.size(); ++p)
    std::printf("d/d %-13s of the range q L at C_I = 1/2: %11.5g +- %.2g\n", names[p].c_str(),
                range.value[p].real(), range.error[p]);
}

std::string shown_change(const CovarianceRequest& request, std::size_t number) {
  if (!request.has_reference()) return shown_channel(request, static_cast<std::uint32_t>(number));
  char text[24];
  std::snprintf(text, sizeof text, "%-17.6g", request.tilts[number]);
  return text;
}

void print_changes(const CovarianceRequest& request, const char* change,
                   const std::vector<double>& sizes, const Estimate& correlation,
                   const char* what) {
  const bool tilts = request.has_reference();
  std::printf("%-17s %10s %21s %9s\n", tilts ? "tilt" : "light    view", change, what, "error");
  const std::size_t channels = tilts ? request.moves : request.channels.size(),
                    rows = channels * sizes.size();
  for (std::size_t row = 0; row < std::min(rows, most_rows); ++row) {
    const std::size_t c = row / sizes.size(), t = row % sizes.size(), i = t * channels + c;
    std::printf("%s %10.4g %21s %9.2g\n", shown_change(request, c).c_str(), sizes[t],
                shown_value(correlation.value[i]).c_str(), correlation.error[i]);
  }
  if (rows > most_rows) std::printf("... and %zu more\n", rows - most_rows);
}

}  // namespace flatspeckle::apps
