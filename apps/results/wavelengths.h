#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/keys/keys.h"
#include "flatland/media/index_field.h"
#include "flatland/placement/placement.h"

namespace flatspeckle::apps {

/// The wavelengths that solve is asked for, in place of one.
struct SpectrumSettings {
  std::vector<double> wavelengths;
  std::optional<std::int64_t> wavelength_count;  ///< between the two of `wavelengths`
  std::string index_table;
};
void add_spectrum_keys(Keys& keys, SpectrumSettings& settings);

/// Wavelengths, and what placements are at each of them.
struct WavelengthList {
  std::vector<double> values;
  std::optional<IndexTable> index;

  /// With the index of the table, where there is one.
  Placement at(double wavelength, Placement placement) const;
};
/// Empty where only one is asked for. Throws InputError, for a table that does not cover them too.
WavelengthList wavelength_list(const Keys& keys, const SpectrumSettings& settings);

}  // namespace flatspeckle::apps
