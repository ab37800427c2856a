#include "grin/render/values/glass.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <vector>

#include "core/error.h"

namespace flatspeckle::grin {

namespace {

using Sellmeier = std::array<double, 6>;

struct Glass {
  const char* name;
  Sellmeier coefficients;  ///< B1, B2, B3, C1, C2, C3; C in square micrometres
};

/// Coefficients of the data sheets of Schott, and of [malitson1965] for silica.
constexpr Glass glasses[] = {
    {"N-BK7", {1.03961212, 0.231792344, 1.01046945, 0.00600069867, 0.0200179144, 103.560653}},
    {"N-F2", {1.39757037, 0.159201403, 1.2686543, 0.00995906143, 0.0546931752, 119.248346}},
    {"N-SF5", {1.52481889, 0.187085527, 1.42729015, 0.011254756, 0.0588995392, 129.141675}},
    {"N-SF6", {1.77931763, 0.338149866, 2.08734474, 0.0133714182, 0.0617533621, 174.01759}},
    {"N-SF11", {1.73759695, 0.313747346, 1.89878101, 0.013188707, 0.0623068142, 155.23629}},
    {"N-BAF10", {1.5851495, 0.143559385, 1.08521269, 0.00926681282, 0.0424489805, 105.613573}},
    {"silica",
     {0.6961663, 0.4079426, 0.8974794, 0.0684043 * 0.0684043, 0.1162414 * 0.1162414,
      9.896161 * 9.896161}}};

// Wavelengths in micrometres of the spectral lines d, F and C, which define the Abbe number.
constexpr double line_d = 0.5875618, line_f = 0.4861327, line_c = 0.6562725;

double sellmeier(const Sellmeier& c, double wavelength) {
  const double square = wavelength * wavelength;
  double sum = 1;
  for (std::size_t i = 0; i < 3; ++i) sum += c[i] * square / (square - c[i + 3]);
  return std::sqrt(sum);
}

double by_abbe_number(double index, double abbe, double wavelength) {
  const auto inverse = [](double w) { return 1 / (w * w); };
  const double dispersion = (index - 1) / abbe;
  return index +
         dispersion * (inverse(wavelength) - inverse(line_d)) / (inverse(line_f) - inverse(line_c));
}

/// Returns the numbers of a text such as "1.5168/64.17"; an empty list if it has others words.
std::vector<double> numbers_of(const std::string& text) {
  std::vector<double> numbers;
  const char* at = text.c_str();
  for (;;) {
    char* end = nullptr;
    const double number = std::strtod(at, &end);
    if (end == at || !std::isfinite(number) || (*end != '/' && *end != '\0')) return {};
    numbers.push_back(number);
    if (*end == '\0') return numbers;
    at = end + 1;
  }
}

double index_of(const std::string& key, const std::string& glass, double wavelength) {
  const auto known =
      std::ranges::find_if(glasses, [&](const Glass& one) { return glass == one.name; });
  if (known != std::end(glasses)) return sellmeier(known->coefficients, wavelength);
  const std::vector<double> numbers = numbers_of(glass);
  if (numbers.size() == 2 && numbers[1] > 0)
    return by_abbe_number(numbers[0], numbers[1], wavelength);
  if (numbers.size() == 6) {
    Sellmeier coefficients{};
    std::ranges::copy(numbers, coefficients.begin());
    return sellmeier(coefficients, wavelength);
  }
  throw InputError(
      key, glass, "must be nd/Vd (as 1.5168/64.17), B1/B2/B3/C1/C2/C3, or one of " + glass_names());
}

}  // namespace

std::string glass_names() {
  std::string names;
  for (const Glass& glass : glasses) names += (names.empty() ? "" : ", ") + std::string(glass.name);
  return names;
}

double glass_index(const std::string& key, const std::string& glass, double micrometres) {
  const double index = index_of(key, glass, micrometres);
  if (!(index >= 1 && index < 10))
    throw InputError(
        key, glass,
        "has no real index at a wavelength of " + std::to_string(micrometres) + " micrometres");
  return index;
}

}  // namespace flatspeckle::grin
