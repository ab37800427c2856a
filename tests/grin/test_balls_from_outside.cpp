// Nested and adjacent balls against analog photon tracing. These tests are nightly, as they take
// minutes; test_against_photons has single balls.

#include <doctest/doctest.h>

#include "tests/grin/seen_from_outside.h"

namespace flatspeckle::grin::tests::test_balls_from_outside {

using namespace oracles;

namespace {

/// Adds a ball to the estimators' scene and to the oracle's.
void add_ball(TwoScenes& scenes, const Vec3& centre, double radius, double index, double mu_s,
              double mu_a) {
  scenes.scene.stage.bodies.push_back(
      {Sphere{centre, radius}, {.mu_s = mu_s, .mu_a = mu_a}, index - 1});
  scenes.walk.balls.push_back({centre, radius, {.mu_s = mu_s, .mu_a = mu_a}, index});
}

/// Returns a ball with a smaller one inside and another beside it.
TwoScenes three_balls(const AnyIndexField& field, const WalkScene& walk, const Light& light,
                      const PhotonSource& source) {
  TwoScenes scenes = body_from_outside(field, walk, light, source);
  add_ball(scenes, {0.2, 0.1, -0.3}, 0.5, 1.6, 2, 0.5);
  add_ball(scenes, {1.1, 0.2, 1.1}, 0.5, 1.2, 1, 0);
  return scenes;
}

}  // namespace

TEST_CASE(
    "nightly: nested and adjacent glass balls: a lens camera agrees with analog photons, a pinhole "
    "with the lens") {
  check_lens_and_pinhole(
      three_balls(Homogeneous{0.4}, ball_walk(1.4), side_point, point_source({0, 0, -1.5})),
      6000000, 400000, 0.06);
  check_lens_and_pinhole(three_balls(Homogeneous{0.4}, ball_walk(1.4), side_beam,
                                     beam_source({0, 0, -1.9}, {0, 0, 1}, 0.8)),
                         3000000, 200000, 0.06);
}

TEST_CASE(
    "nightly: ball in a ball of the same index: a lens camera agrees with analog photons, a "
    "pinhole with the lens") {
  TwoScenes scenes =
      body_from_outside(Homogeneous{0.4}, ball_walk(1.4), side_point, point_source({0, 0, -1.5}));
  add_ball(scenes, {0.2, 0.1, -0.3}, 0.5, 1.4, 3, 1);
  check_lens_and_pinhole(scenes, 6000000, 400000);
}

TEST_CASE(
    "nightly: glass balls in and beside a Luneburg ball: a lens camera agrees with analog photons, "
    "a pinhole with the lens") {
  const WalkScene walk = luneburg_walk();
  check_lens_and_pinhole(three_balls(Luneburg({}), walk, side_point, point_source({0, 0, -1.5})),
                         1500000, 100000, 0.1);
}

}  // namespace flatspeckle::grin::tests::test_balls_from_outside
