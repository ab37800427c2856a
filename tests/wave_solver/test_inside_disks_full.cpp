#include <doctest/doctest.h>

#include "inside_disks.h"

namespace flatspeckle::wave {

TEST_CASE(
    "Fields are within the tolerance on both sides of the rims: 60 clusters of 2 to 6 disks") {
  const std::vector<double> tolerances{1e-3, 1e-6, 1e-9, 1e-12};
  const auto worst = worst_errors(100, 60, 6, tolerances);
  for (std::size_t i = 0; i < worst.size(); ++i) {
    CAPTURE(tolerances[i]);
    CHECK(worst[i].inside < 1);
    CHECK(worst[i].outside < 1);
  }
}

}  // namespace flatspeckle::wave
