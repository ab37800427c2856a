#include <doctest/doctest.h>

#include "bench/oracles/space_pair_walk.h"
#include "tests/mc/space/scenes_in_space.h"
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
        const auto found = slab_covariance(slab, request, false, {1e-4}).value[0];
        CHECK(std::abs(found.real() - value.real()) < 4 * error);
        CHECK(std::abs(found.imag() - value.imag()) < 4 * error);
        CHECK(error < 0.02 * std::abs(found));
      }
    }
}

TEST_CASE("slabs in space: Monte Carlo and transport agree, errors of 0.3 %") {
  for (const double g : {0.9, 0.98})
    for (const double optical_depth : {5.0, 20.0})
      for (const double albedo : {0.9, 1.0}) {
        constexpr double depth = 1000;
        const auto scene = tests::in_space(tests::hg_in_space(depth, optical_depth, g, albedo),
                                           tests::tilted_pairs(0, 0, {0, 1 / depth, 2 / depth}));
        tests::check_agreement(scene, false, g > 0.95 ? 16000000 : 6000000, 0.003);
      }
}

}  // namespace flatspeckle::mc
