// Balls in balls and beside each other against analog photons. Nightly: beside single balls, which
// test_against_photons sees, it takes minutes.

#include <doctest/doctest.h>

#include "tests/grin/seen_from_outside.h"

namespace flatspeckle::grin::tests::test_balls_from_outside {

using namespace oracles;

namespace {

/// The same ball twice: for the estimators and for the oracle.
void add_ball(TwoScenes& scenes, const Vec3& centre, double radius, double index, double mu_s,
              double mu_a) {
  scenes.scene.stage.bodies.push_back(
      {Sphere{centre, radius}, {.mu_s = mu_s, .mu_a = mu_a}, index - 1});
  scenes.walk.balls.push_back({centre, radius, {.mu_s = mu_s, .mu_a = mu_a}, index});
}

/// A ball within a ball, and one beside them.
TwoScenes three_balls(const AnyIndexField& field, const WalkScene& walk, const Light& light,
                      const PhotonSource& source) {
  TwoScenes scenes = body_from_outside(field, walk, light, source);
  add_ball(scenes, {0.2, 0.1, -0.3}, 0.5, 1.6, 2, 0.5);
  add_ball(scenes, {1.1, 0.2, 1.1}, 0.5, 1.2, 1, 0);
  return scenes;
}

}  // namespace

TEST_CASE(
    "nightly: a ball within a ball and one beside, seen from outside by a lens and a pinhole") {
  check_lens_and_pinhole(
      three_balls(Homogeneous{0.4}, ball_walk(1.4), side_point, point_source({0, 0, -1.5})),
      6000000, 400000, 0.06);
  check_lens_and_pinhole(three_balls(Homogeneous{0.4}, ball_walk(1.4), side_beam,
                                     beam_source({0, 0, -1.9}, {0, 0, 1}, 0.8)),
                         3000000, 200000, 0.06);
}

TEST_CASE("nightly: a ball of the same index as the one around it, seen from outside") {
  TwoScenes scenes =
      body_from_outside(Homogeneous{0.4}, ball_walk(1.4), side_point, point_source({0, 0, -1.5}));
  add_ball(scenes, {0.2, 0.1, -0.3}, 0.5, 1.4, 3, 1);
  check_lens_and_pinhole(scenes, 6000000, 400000);
}

TEST_CASE("nightly: a glass ball in a Luneburg ball, seen from outside by a lens and a pinhole") {
  const WalkScene walk = luneburg_walk();
  check_lens_and_pinhole(three_balls(Luneburg({}), walk, side_point, point_source({0, 0, -1.5})),
                         1500000, 100000, 0.1);
}

}  // namespace flatspeckle::grin::tests::test_balls_from_outside
