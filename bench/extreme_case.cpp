#include "bench/extreme_case.h"

#include <cmath>
#include <limits>
#include <sstream>
#include <stdexcept>

#include "bench/extreme_rows.h"

namespace flatspeckle::bench {

std::vector<ExtremeCase> extreme_cases() {
  std::vector<ExtremeCase> all;
  for (const auto& room :
       {function_extremes, flatland_extremes, wave_extremes, wave_point_extremes, mc_theory_extremes,
        mc_slab_extremes, mc_box_extremes, index_extremes, ray_extremes, connection_extremes,
        flight_extremes, render_extremes})
    for (ExtremeCase& row : room()) all.push_back(std::move(row));
  return all;
}

Finding examine(const ExtremeCase& extreme) {
  try {
    return extreme.run();
  } catch (const std::runtime_error& error) {  // InputError, or what did not converge
    return {0, 0, error.what()};
  }
}

bool passes(const ExtremeCase& extreme, const Finding& finding) {
  if (!extreme.must_say.empty()) return finding.refusal.find(extreme.must_say) != std::string::npos;
  return finding.refusal.empty() && finding.figure <= finding.limit;
}

Finding in_errors(Complex found, double error, Complex expected, double largest_error,
                  double accuracy) {
  constexpr double limit = 4;
  const double size = std::abs(expected), off = std::abs(found - expected) - accuracy * size;
  if (!(error <= largest_error * size)) return {std::numeric_limits<double>::infinity(), limit};
  return {off <= 0 ? 0 : off / error, limit};
}

Finding worse(const Finding& a, const Finding& b) {
  return a.figure <= b.figure ? b : a;  // NaN is the worst
}

std::string short_number(double value) {
  std::ostringstream text;
  text << value;
  std::string digits = text.str();
  for (const char* zero : {"e-0", "e+0", "e+"})
    if (const auto at = digits.find(zero); at != std::string::npos)
      digits.replace(at, std::string(zero).size(), zero[1] == '-' ? "e-" : "e");
  return digits;
}

}  // namespace flatspeckle::bench
