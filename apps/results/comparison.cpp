#include "apps/results/comparison.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "apps/results/moments_table.h"

namespace flatspeckle::apps {

double Comparison::error(std::size_t e) const {
  const double largest = std::max(std::abs(reference.value[e]), std::abs(mc.value[e]));
  return std::hypot(reference.error[e], mc.error[e], 1e-13 * largest);
}

double Comparison::difference(std::size_t e) const {
  return std::abs(mc.value[e] - reference.value[e]);
}

double Comparison::deviation(std::size_t e) const {
  return difference(e) == 0 ? 0 : difference(e) / error(e);
}

std::vector<double> Comparison::deviations() const {
  std::vector<double> all;
  for (std::size_t e = 0; e < mc.value.size(); ++e) all.push_back(deviation(e));
  return all;
}

double Comparison::scale(std::size_t e) const {
  return correlations ? 1 : std::abs(reference.value[e]);
}

std::optional<Comparison::Whole> Comparison::whole() const {
  double differences = 0, errors = 0, references = 0;
  std::size_t entries = 0, within = 0;
  for (std::size_t e = 0; e < mc.value.size(); ++e) {
    if (is_apart(e)) continue;
    differences += std::norm(mc.value[e] - reference.value[e]);
    errors += error(e) * error(e);
    references += std::norm(reference.value[e]);
    within += within_errors(e) || within_bias(e) ? 1 : 0;
    ++entries;
  }
  if (entries == 0 || references == 0) return std::nullopt;
  return Whole{std::sqrt(differences / references), std::sqrt(errors / references),
               static_cast<double>(within) / static_cast<double>(entries)};
}

namespace {

void print_row(const Comparison& comparison, std::size_t e, const RowNames& names) {
  const double scale = std::max(comparison.scale(e), 1e-300);
  std::printf("%s  %21s %8.2g  %21s %8.2g  %6.1f %%  %5.1f%s\n", names.of(e).c_str(),
              shown_value(comparison.mc.value[e]).c_str(), comparison.mc.error[e],
              shown_value(comparison.reference.value[e]).c_str(), comparison.reference.error[e],
              100 * comparison.difference(e) / scale, comparison.deviation(e),
              comparison.is_apart(e)        ? "  forward"
              : comparison.within_errors(e) ? ""
              : comparison.within_bias(e)   ? "  within"
                                            : "  *");
}

}  // namespace

Agreement print_comparison(const Comparison& comparison, std::size_t values,
                           const RowNames& names) {
  std::printf("%s  %21s %8s  %21s %8s  %8s  %s\n", names.head.c_str(), "mc", "error",
              comparison.name.c_str(), "error", "|diff|", "sigma");
  Agreement agreement;
  for (std::size_t e = 0; e < values; ++e) {
    if (e < most_rows) print_row(comparison, e, names);
    if (comparison.is_apart(e))
      ++agreement.apart;
    else if (comparison.within_errors(e))
      ++agreement.in_errors;
    else if (comparison.within_bias(e))
      ++agreement.in_bias;
  }
  if (values > most_rows) std::printf("... and %zu more\n", values - most_rows);
  return agreement;
}

}  // namespace flatspeckle::apps
