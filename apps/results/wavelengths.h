#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/keys/keys.h"
#include "flatland/media/index_field.h"
#include "flatland/placement/placement.h"

namespace flatspeckle::apps {

/// Values of the keys by which `solve` computes several wavelengths instead of one.
struct SpectrumSettings {
  std::vector<double> wavelengths;
  /// If given, `wavelengths` contains the first and the last wavelength, and this is the number of
  /// equidistant wavelengths.
  std::optional<std::int64_t> wavelength_count;
  std::string index_table;
};
void add_spectrum_keys(Keys& keys, SpectrumSettings& settings);

/// Wavelengths, and optionally the refractive index of the scatterers as a function of wavelength.
struct WavelengthList {
  std::vector<double> values;
  std::optional<IndexTable> index;

  /// Returns the placement with the refractive index of its scatterers at this wavelength;
  /// unchanged if there is no table of the index.
  Placement at(double wavelength, Placement placement) const;
};
/// Returns the list of wavelengths; it is empty if only the key `wavelength` is given. Throws
/// InputError, also if the table of the index does not cover all wavelengths.
WavelengthList wavelength_list(const Keys& keys, const SpectrumSettings& settings);

}  // namespace flatspeckle::apps
