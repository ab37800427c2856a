// The rows of the stability table (bench_wave_stability).

#include <doctest/doctest.h>

#include "wave_extremes.h"

namespace flatspeckle::wave {

TEST_CASE("Extreme cases are right, or refused with a clear error") {
  for (const ExtremeCase& extreme : extreme_cases()) {
    const Finding finding = examine(extreme);
    CAPTURE(extreme.name);
    CAPTURE(extreme.invariant);
    CAPTURE(finding.figure);
    CAPTURE(finding.limit);
    CAPTURE(finding.refusal);
    CHECK(passes(extreme, finding));
  }
}

}  // namespace flatspeckle::wave
