#pragma once

#include <numbers>
#include <vector>

#include "bench/scenes/render_scenes.h"

// Scenes of render tests: fields and bodies in the box [-1, 1]^3 or a ball of radius 1.5.
namespace flatspeckle::bench {

inline constexpr double right_angle = std::numbers::pi / 2;

grin::Surface unit_box();

grin::Light environment();
/// A detector that covers the box's face at z = 1.
grin::AreaDetector whole_face();

grin::RenderScene scene_in(grin::AnyIndexField field, grin::Stage stage, grin::Light light,
                           grin::Sensor sensor);

/// Returns the mean of n^2 over the face at z = 1. If the field contains sound, it also averages
/// over the phase of the sound.
double mean_square_index(const grin::RenderScene& scene);

}  // namespace flatspeckle::bench
