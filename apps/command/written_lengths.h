#pragma once

#include <optional>
#include <string>

#include "core/keys/key.h"

namespace flatspeckle::apps {

/// Metres of "um", "0.5mm" or "1e-6"; no value if the text is anything else.
std::optional<double> metres_of(const std::string& text);

/// What is given of a key with "532nm" as numbers of the scene's unit of length, which has so many
/// metres; likewise "10/mm" and "0.05/um^2" of keys whose unit is the inverse of a length or of its
/// square. Other texts as they are. Throws InputError where the unit of length is not given.
std::string in_unit_of_length(const Key& key, const std::string& text,
                              const std::optional<double>& metres);

}  // namespace flatspeckle::apps
