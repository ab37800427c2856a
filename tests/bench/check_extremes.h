#pragma once

#include <doctest/doctest.h>

#include "bench/stability/extreme_case.h"
#include "tests/statistics.h"

namespace flatspeckle::bench::tests {

/// The quick or the slow rows of the stability table; of the quick ones every other by day.
inline void check_extremes(bool slow) {
  int rows = 0;
  for (const ExtremeCase& extreme : extreme_cases()) {
    if (extreme.slow != slow) continue;
    if (++rows % 2 == 0 && !flatspeckle::tests::is_night) continue;
    const Finding finding = examine(extreme);
    CAPTURE(extreme.room);
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
