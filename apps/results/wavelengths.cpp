#include "apps/results/wavelengths.h"

#include <algorithm>

#include "core/error.h"
#include "core/keys/number_text.h"

namespace flatspeckle::apps {

namespace {

/// As many, in equal steps.
std::vector<double> steps(const std::vector<double>& ends, std::int64_t count) {
  if (ends.size() != 2)
    throw InputError("wavelength_count", std::to_string(count),
                     "counts wavelengths from the first to the last: give two wavelengths");
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
    throw InputError("wavelengths", *twice, "is given twice");
}

}  // namespace

void add_spectrum_keys(Keys& keys, SpectrumSettings& settings) {
  keys.group("Wavelengths");
  keys.add("wavelengths", settings.wavelengths,
           "Solve the placement at each of these; `wavelength` then is that at which the medium's "
           "density is meant")
      .positive()
      .unit("length");
  keys.add("wavelength_count", settings.wavelength_count,
           "As many in equal steps, from the first of two wavelengths to the second")
      .from(2, 100'000)
      .only_of("wavelengths");
  keys.add("index_table", settings.index_table,
           "CSV with columns wavelength, index_re, index_im: the index at each wavelength, linear "
           "between")
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
