#include "apps/results/wavelengths.h"

#include <algorithm>

#include "core/error.h"
#include "core/keys/number_text.h"

namespace flatspeckle::apps {

namespace {

/// Returns `count` equidistant values from ends[0] to ends[1], both included.
std::vector<double> steps(const std::vector<double>& ends, std::int64_t count) {
  if (ends.size() != 2)
    throw InputError("wavelength_count", std::to_string(count),
                     "requires exactly two wavelengths, the first and the last");
  std::vector<double> values;
  for (std::int64_t i = 0; i < count; ++i) {
    const double share = static_cast<double>(i) / static_cast<double>(count - 1);
    values.push_back((1 - share) * ends[0] + share * ends[1]);
  }
  return values;
}

void require_distinct(std::vector<double> values) {
  std::ranges::sort(values);
  if (const auto twice = std::ranges::adjacent_find(values); twice != values.end())
    throw InputError("wavelengths", *twice, "is given twice; leave one out");
}

}  // namespace

void add_spectrum_keys(Keys& keys, SpectrumSettings& settings) {
  keys.group("Wavelengths");
  keys.add("wavelengths", settings.wavelengths,
           "Wavelengths at which the placement is solved; `wavelength` then only defines the "
           "density of the medium")
      .positive()
      .unit("length");
  keys.add("wavelength_count", settings.wavelength_count,
           "Number of equidistant wavelengths from the first of two wavelengths to the second")
      .from(2, 100'000)
      .only_of("wavelengths");
  keys.add("index_table", settings.index_table,
           "CSV file with columns wavelength, index_re, index_im: index at each wavelength, "
           "interpolated linearly")
      .file()
      .only_of("wavelengths of tm and te");
}

WavelengthList wavelength_list(const Keys& keys, const SpectrumSettings& settings) {
  WavelengthList list{keys.read(settings.wavelengths), {}};
  if (list.values.empty()) return list;
  if (const auto count = keys.read(settings.wavelength_count))
    list.values = steps(list.values, *count);
  require_distinct(list.values);
  if (keys.read(settings.index_table).empty()) return list;
  list.index.emplace(settings.index_table);
  for (const double wavelength : list.values) list.index->at(wavelength);
  return list;
}

Placement WavelengthList::at(double wavelength, Placement placement) const {
  if (!index) return placement;
  for (PlacedScatterer& placed : placement)
    if (placed.scatterer.is_penetrable()) placed.scatterer.index = index->at(wavelength);
  return placement;
}

}  // namespace flatspeckle::apps
