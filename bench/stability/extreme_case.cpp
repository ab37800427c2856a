#include "bench/stability/extreme_case.h"

#include <charconv>
#include <cmath>
#include <exception>
#include <iterator>
#include <limits>

#include "bench/stability/extreme_rows.h"

namespace flatspeckle::bench {

std::vector<ExtremeCase> extreme_cases() {
  struct Part {
    const char* module_name;
    void (*add)(ExtremeRows& rows);
  };
  constexpr Part parts[] = {{"functions", function_extremes},
                            {"search", search_extremes},
                            {"flatland", flatland_extremes},
                            {"wave_solver", wave_extremes},
                            {"wave_solver", wave_point_extremes},
                            {"wave_solver", wave_space_extremes},
                            {"mc", mc_theory_extremes},
                            {"mc", mc_slab_extremes},
                            {"mc", mc_transport_extremes},
                            {"mc", mc_box_extremes},
                            {"mc", mc_space_extremes},
                            {"mc", mc_varying_extremes},
                            {"mc imaging", mc_imaging_extremes},
                            {"grin", index_extremes},
                            {"grin", ray_extremes},
                            {"grin", connection_extremes},
                            {"grin", flight_extremes},
                            {"grin", render_extremes},
                            {"grin", mesh_extremes},
                            {"grin", design_extremes}};
  ExtremeRows rows;
  for (const auto& [module_name, add] : parts) {
    rows.begin_module(module_name);
    add(rows);
  }
  return std::move(rows).rows();
}

Finding examine(const ExtremeCase& extreme) {
  try {
    return extreme.run();
  } catch (const std::exception& error) {  // InputError, or any other failure
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

Finding in_errors(const Estimate& found, const Estimate& expected, double largest_error,
                  double scale) {
  Finding worst{0, 4};
  for (std::size_t i = 0; i < found.value.size(); ++i)
    worst = worse(worst, in_errors(scale * found.value[i],
                                   std::hypot(scale * found.error[i], expected.error[i]),
                                   expected.value[i], largest_error));
  return worst;
}

Finding in_errors(const Estimate& found, const std::vector<Complex>& expected, double largest_error,
                  double accuracy) {
  Finding worst{0, 4};
  for (std::size_t i = 0; i < expected.size(); ++i)
    worst = worse(worst,
                  in_errors(found.value[i], found.error[i], expected[i], largest_error, accuracy));
  return worst;
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
