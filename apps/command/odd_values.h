#pragma once

#include "core/keys/keys.h"

namespace flatspeckle::apps {

/// Prints notes on standard error for values that are valid but are often mistakes: no scatterers,
/// a refractive index n that may be meant as n - 1, or an excess n - 1 that may be meant as n.
void note_odd_values(const Keys& keys);

}  // namespace flatspeckle::apps
