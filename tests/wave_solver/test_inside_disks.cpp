#include <string>

#include <doctest/doctest.h>

#include "inside_disks.h"

namespace flatspeckle::wave {

TEST_CASE("Fields are within the tolerance on both sides of the rims: small clusters") {
  const std::vector<double> tolerances{1e-3, 1e-6, 1e-9};
  const auto worst = worst_errors(107, 4, {13, 1300}, tolerances);
  for (std::size_t i = 0; i < worst.size(); ++i) {
    CAPTURE(tolerances[i]);
    CHECK(worst[i].inside < 1);
    CHECK(worst[i].outside < 1);
  }
}

TEST_CASE("Fields in narrow gaps are within the tolerance, on both of the rims that face it") {
  for (const std::string kind : {"D", "N", "TM15", "TE15"}) {
    CAPTURE(kind);
    check_gap(kind, 1, 0.1, {1e-3, 1e-6, 1e-9});
    check_gap(kind, 0.2, 0.03, {1e-3, 1e-6, 1e-9});
  }
}

}  // namespace flatspeckle::wave
