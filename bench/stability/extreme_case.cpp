#include "bench/stability/extreme_case.h"

#include <charconv>
#include <cmath>
#include <exception>
#include <iterator>
#include <limits>

#include "bench/stability/extreme_rows.h"

namespace flatspeckle::bench {

std::vector<ExtremeCase> extreme_cases() {
  std::vector<ExtremeCase> all;
  for (const auto& room :
       {function_extremes, flatland_extremes, wave_extremes, wave_point_extremes,
        wave_cluster_extremes, mc_theory_extremes, mc_slab_extremes, mc_transport_extremes,
        mc_box_extremes, mc_varying_extremes, mc_imaging_extremes, index_extremes, ray_extremes,
        connection_extremes, flight_extremes, render_extremes, mesh_extremes, design_extremes})
    for (ExtremeCase& row : room()) all.push_back(std::move(row));
  return all;
}

Finding examine(const ExtremeCase& extreme) {
  try {
    return extreme.run();
  } catch (const std::exception& error) {  // InputError, or what fails by itself
    return {0, 0, error.what()};
  }
}

bool passes(const ExtremeCase& extreme, const Finding& finding) {
  if (!extreme.must_say.empty()) return finding.refusal.find(extreme.must_say) != std::string::npos;
  return finding.refusal.empty() && finding.figure <= finding.limit;
}

double relative_difference(const std::vector<Complex>& a, const std::vector<Complex>& b) {
  double difference = 0, size = 0;
  for (std::size_t i = 0; i < b.size(); ++i) {
    difference += std::norm(a[i] - b[i]);
    size += std::norm(b[i]);
  }
  return std::sqrt(difference / size);
}

Finding in_errors(Complex found, double error, Complex expected, double largest_error,
                  double accuracy) {
  constexpr double limit = 4;
  const double size = std::abs(expected), off = std::abs(found - expected) - accuracy * size;
  if (!(error <= largest_error * size)) return {std::numeric_limits<double>::infinity(), limit};
  return {off <= 0 ? 0 : off / error, limit};
}

Finding worse(const Finding& a, const Finding& b) {
  return std::isnan(a.figure) || a.figure > b.figure ? a : b;
}

std::string short_number(double value) {
  char text[32];
  std::string digits(text, std::to_chars(text, std::end(text), value).ptr);
  const auto exponent = digits.find('e');
  if (exponent != std::string::npos)
    digits =
        digits.substr(0, exponent + 1) + std::to_string(std::stoi(digits.substr(exponent + 1)));
  return digits;
}

}  // namespace flatspeckle::bench
