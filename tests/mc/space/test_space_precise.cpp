#include <doctest/doctest.h>

#include "bench/oracles/space_pair_walk.h"
#include "tests/mc/space/slabs_in_space.h"

namespace flatspeckle::mc {

TEST_CASE("slabs in space: forward peaks and absorption as in a walk of pairs") {
  constexpr double depth = 1000;
  for (const double g : {0.9, 0.98})
    for (const double albedo : {0.9, 1.0}) {
      const auto slab = tests::hg_space(depth, 5, g, albedo);
      for (const double turn : {0.0, 2.0, 5.0}) {
        const auto normal = tests::downward(0, 0),
                   tilted = tests::downward(turn / slab.k / depth, 0);
        const oracles::SpacePairWalk walk{
            slab.k / slab.mu_t, 5, g, albedo, normal, tilted, normal, tilted};
        const auto [value, error] = walk.estimate(400000, 1, true);
        const auto request = tests::against_first({normal, tilted}, {normal, tilted});
        const auto found = space_covariance(slab, request, false, {1e-4}).value[0];
        CHECK(std::abs(found.real() - value.real()) < 4 * error);
        CHECK(std::abs(found.imag() - value.imag()) < 4 * error);
        CHECK(error < 0.02 * std::abs(found));
      }
    }
}

}  // namespace flatspeckle::mc
