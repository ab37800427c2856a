#pragma once

#include "core/keys/keys.h"

namespace flatspeckle::apps {

/// Says on standard error which values can be used and are more often slips: no scatterers, and
/// indices that look like n - 1, or n - 1 that looks like n.
void note_odd_values(const Keys& keys);

}  // namespace flatspeckle::apps
