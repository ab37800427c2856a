#include "apps/fit/fit_comparison.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "core/error.h"
#include "core/result/guarded_read.h"
#include "core/result/result_reader.h"

namespace flatspeckle::apps {

namespace {

struct ComparedFit {
  std::string path, scatterer;
  std::vector<double> measured;
  double chi_squared = 0, parameters = 0;

  double freedom() const { return static_cast<double>(measured.size()) - parameters; }
  double information() const { return chi_squared + 2 * parameters; }
};

/// The word after a key in a configuration.
std::string word_of(const std::string& config, const std::string& key) {
  const std::string start = key + " = \"";
  const auto found = config.find(start);
  if (found == std::string::npos) return "";
  const auto first = found + start.size();
  return config.substr(first, config.find('"', first) - first);
}

ComparedFit fit_of(const std::string& path) {
  const ResultReader file(path);
  if (!file.has("estimate") || !file.has("measured") || !file.has_attribute("/", "chi_squared"))
    throw InputError("compare", path, "is no result of fit");
  ComparedFit fit;
  fit.path = path;
  fit.scatterer = word_of(file.attribute<std::string>("/", "config"), "scatterer");
  fit.measured = file.dataset<double>("measured");
  fit.chi_squared = file.attribute<double>("/", "chi_squared");
  fit.parameters = static_cast<double>(file.dataset<double>("estimate").size());
  return fit;
}

/// Of chi^2 that is as large or larger, by Wilson's and Hilferty's cube root.
double chance(double chi_squared, double freedom) {
  if (freedom < 1) return 1;
  const double width = 2 / (9 * freedom),
               normal = (std::cbrt(chi_squared / freedom) - 1 + width) / std::sqrt(width);
  return std::erfc(normal / std::sqrt(2)) / 2;
}

}  // namespace

void print_comparison(const std::vector<std::string>& paths) {
  std::vector<ComparedFit> fits;
  for (const std::string& path : paths) {
    fits.push_back(guarded_read(path, [&] { return fit_of(path); }));
    if (fits.back().measured != fits.front().measured)
      throw InputError("compare", path, "fits other measurements than " + paths.front());
  }
  std::ranges::sort(fits, {}, &ComparedFit::information);
  double sum = 0;
  const auto weight = [&](const ComparedFit& fit) {
    return std::exp((fits.front().information() - fit.information()) / 2);
  };
  for (const ComparedFit& fit : fits) sum += weight(fit);
  std::printf("%-28s %-12s %10s %10s %10s %10s %10s\n", "fit", "scatterer", "parameters", "chi^2",
              "freedom", "chance", "weight");
  for (const ComparedFit& fit : fits)
    std::printf("%-28s %-12s %10g %10.4g %10g %10.2g %10.2g\n", fit.path.c_str(),
                fit.scatterer.c_str(), fit.parameters, fit.chi_squared, fit.freedom(),
                chance(fit.chi_squared, fit.freedom()), weight(fit) / sum);
}

}  // namespace flatspeckle::apps
