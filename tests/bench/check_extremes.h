#pragma once

#include <doctest/doctest.h>

#include "bench/stability/extreme_case.h"
#include "tests/statistics.h"

namespace flatspeckle::bench::tests {

/// Checks the quick or the slow rows of the stability table. By day only every second quick row is
/// checked.
inline void check_extremes(bool slow) {
  int rows = 0;
  for (const ExtremeCase& extreme : extreme_cases()) {
    if (extreme.slow != slow) continue;
    if (++rows % 2 == 0 && !flatspeckle::tests::is_night) continue;
    const Finding finding = examine(extreme);
    CAPTURE(extreme.module_name);
    CAPTURE(extreme.name);
    CAPTURE(extreme.invariant);
    CAPTURE(finding.figure);
    CAPTURE(finding.limit);
    CAPTURE(finding.refusal);
    CHECK(passes(extreme, finding));
  }
  CHECK(rows > 0);
}

}  // namespace flatspeckle::bench::tests
