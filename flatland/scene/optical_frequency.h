#pragma once

#include <optional>
#include <string>
#include <vector>

#include "flatland/scene/scene.h"

namespace flatspeckle {

/// Returns the optical frequency of the scene in Hz. It is known if the wavelength is that in
/// vacuum (medium_index is given) and if the scene's unit of length in metres is given.
std::optional<double> optical_frequency(const SceneSpec& spec, const std::optional<double>& metres);

/// Whether numbers are differences between two frequencies, or widths (FWHM) of a spectrum.
enum class FrequencyKind { shift, width };

/// Parses the texts of a key: plain numbers, which are relative to the optical frequency, or
/// frequencies (1GHz), changes of the vacuum wavelength (0.1nm) or of the wavenumber 1/wavelength
/// (0.5/cm). Returns relative frequencies. A shift of the wavelength is converted exactly, a width
/// to first order. Throws InputError for other texts, for plain numbers (other than 0) beside units
/// in one text, and for units if optical_frequency() is not known.
std::vector<double> relative_frequencies(const std::string& key,
                                         const std::vector<std::string>& texts,
                                         const std::optional<double>& optical, FrequencyKind kind);

}  // namespace flatspeckle
