#pragma once

#include <span>
#include <vector>

#include "core/keys/keys.h"
#include "grin/rays/surfaces/lens.h"

namespace flatspeckle::grin {

// Lenses as keys have them.

inline constexpr int lens_numbers = 7;
inline constexpr const char* lens_words = "x y z radius front back thickness";

/// Of that many numbers. Throws InputError, naming the key, for what is no lens.
Lens lens_of(const std::string& key, std::span<const double> numbers);
std::vector<Lens> lenses_of(const Keys& keys, const std::vector<double>& member);

}  // namespace flatspeckle::grin
