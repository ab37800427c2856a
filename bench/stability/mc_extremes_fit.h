#pragma once

#include "bench/stability/extreme_rows.h"

namespace flatspeckle::bench {

/// Media found again from their own curves.
void add_fits(ExtremeRows& rows);

}  // namespace flatspeckle::bench
