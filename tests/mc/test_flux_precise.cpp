#include "tests/mc/flux_runs.h"

namespace flatspeckle::mc {

TEST_CASE("flux of slabs agrees with discrete ordinates to 0.1 %") {
  std::uint64_t seed = 200;
  for (const double optical_depth : {0.1, 1.0, 10.0})
    for (const double g : {0.0, 0.5, 0.9, -0.5})
      for (const double albedo : {1.0, 0.99, 0.5})
        tests::check_slab(optical_depth, albedo, g, 0.001, ++seed);
}

TEST_CASE("flux through a lossless optical depth of 100 agrees with discrete ordinates to 0.1 %") {
  std::uint64_t seed = 300;
  for (const double g : {0.0, 0.5, 0.9, -0.5}) tests::check_slab(100, 1, g, 0.001, ++seed);
}

TEST_CASE(
    "flux through an absorbing optical depth of 100 agrees with discrete ordinates to 0.5 %") {
  tests::check_slab(100, 0.9, 0, 0.005, 401);
  tests::check_slab(100, 0.9, 0.9, 0.005, 402);
}

}  // namespace flatspeckle::mc
