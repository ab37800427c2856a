#pragma once

#include "tests/grin/photon_comparison.h"

namespace flatspeckle::grin::tests {

/// Returns a body in a clear box, viewed through a side of the box.
TwoScenes body_from_outside(const AnyIndexField& field, const oracles::WalkScene& walk,
                            const Light& light, const oracles::PhotonSource& source,
                            double power = 1);

/// Returns a ball of the given index in a box of index 1.
oracles::WalkScene ball_walk(double inside);
/// Returns the same ball with Luneburg's index.
oracles::WalkScene luneburg_walk();

/// Compares a camera with a lens with the photon walk, and a pinhole camera at the lens's centre
/// with the lens.
void check_lens_and_pinhole(TwoScenes scenes, std::uint64_t photons, unsigned samples,
                            double precision = 0.03);

const inline Light side_point = PointLight{{0, 0, -1.5}};
/// Returns a source of those photons of side_point that meet the ball; photons that miss it are
/// never detected.
oracles::PhotonSource towards_ball();
/// Fraction of the photons of side_point that meet the ball.
constexpr double share_towards_ball = (1 - 0.745) / 2;
const inline Light side_beam = BeamLight{{0, 0, -1.9}, {0, 0, 1}, 0.8};

}  // namespace flatspeckle::grin::tests
