#include "tests/bench/check_extremes.h"

namespace flatspeckle::bench {

TEST_CASE("Extreme cases that take long are right, or refused with a clear error") {
  tests::check_extremes(true);
}

}  // namespace flatspeckle::bench
