#include <cmath>
#include <limits>

#include <doctest/doctest.h>

#include "flatland/media/domain.h"

namespace flatspeckle::test_domain {

TEST_CASE("angles: measured from +z towards +x") {
  CHECK(direction(0).z == 1);
  CHECK(direction(1.5707963267948966).x == 1);
  for (double angle : {-3.0, -1.0, 0.0, 0.5, 3.1})
    CHECK(angle_of(direction(angle)) == doctest::Approx(angle));
}

TEST_CASE("distance to the edge: ends on the edge of a box") {
  const Domain box{Domain::Kind::box, 20, 10};
  for (double angle = -3.1; angle < 3.2; angle += 0.17) {
    const Vec start{3, 7}, w = direction(angle);
    const Vec end = start + box.distance_to_edge(start, w) * w;
    const double to_edge =
        std::min({std::abs(std::abs(end.x) - 10), std::abs(end.z), std::abs(end.z - 10)});
    CHECK(to_edge < 1e-12);
    CHECK(box.contains(start + 0.999 * (end - start)));
    CHECK_FALSE(box.contains(start + 1.001 * (end - start)));
  }
  CHECK(box.distance_to_edge({0, 4}, {1, 0}) == 10);
  CHECK(box.distance_to_edge({0, 4}, {0, -1}) == 4);
}

TEST_CASE("slab: has no lateral edges") {
  const Domain slab{Domain::Kind::slab, 0, 10};
  CHECK(slab.distance_to_edge({1e9, 4}, {0, 1}) == 6);
  CHECK(slab.distance_to_edge({0, 4}, {1, 0}) == std::numeric_limits<double>::infinity());
  CHECK(slab.contains({1e9, 4}));
}

}  // namespace flatspeckle::test_domain
