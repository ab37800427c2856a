#include "tests/grin/curve_sums.h"

namespace flatspeckle::grin::tests {

TEST_CASE("f K has the mean of the sum of f over four curves, to 0.2 %") {
  check_four_curves(600'000, 0.002);
}

}  // namespace flatspeckle::grin::tests
