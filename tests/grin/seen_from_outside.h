#pragma once

#include "tests/grin/photon_comparison.h"

namespace flatspeckle::grin::tests {

/// A body in a clear room, seen from its side.
TwoScenes body_from_outside(const AnyIndexField& field, const oracles::WalkScene& walk,
                            const Light& light, const oracles::PhotonSource& source,
                            double power = 1);

/// A ball of that index in a room of index 1.
oracles::WalkScene ball_walk(double inside);
/// Luneburg's index in that ball.
oracles::WalkScene luneburg_walk();

/// The lens against photons; and the pinhole in its middle against the lens.
void check_lens_and_pinhole(TwoScenes scenes, std::uint64_t photons, unsigned samples,
                            double precision = 0.03);

const inline Light side_point = PointLight{{0, 0, -1.5}};
/// The photons of side_point that meet the ball: no others are seen. Their share of all.
oracles::PhotonSource towards_ball();
constexpr double share_towards_ball = (1 - 0.745) / 2;
const inline Light side_beam = BeamLight{{0, 0, -1.9}, {0, 0, 1}, 0.8};

}  // namespace flatspeckle::grin::tests
