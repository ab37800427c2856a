#pragma once

#include <numbers>
#include <vector>

#include "bench/scenes/render_scenes.h"

// Scenes of render tests: fields and bodies in the box [-1, 1]^3 or a ball of radius 1.5.
namespace flatspeckle::bench {

inline constexpr double right_angle = std::numbers::pi / 2;

grin::Surface unit_box();
grin::Surface ball_stage();

/// Henyey-Greenstein.
grin::ScatteringMedium fog(double mu_s, double mu_a, double g);
/// Rayleigh, with a density on a grid.
grin::ScatteringMedium grid_medium();

grin::Light environment();
/// All of the box's face at z = 1.
grin::AreaDetector whole_face();

grin::RenderScene scene_in(grin::AnyIndexField field, grin::Stage stage, grin::Light light,
                           grin::Sensor sensor);

/// The fields of the white furnace, in the box, under the environment; all that scatters is
/// `medium`.
std::vector<NamedRender> furnaces(const grin::ScatteringMedium& medium);

/// The same with several bodies.
std::vector<NamedRender> furnaces_of_bodies(const grin::ScatteringMedium& medium);

/// Mean of n^2 over the face at z = 1, and over the phases of sound.
double mean_square_index(const grin::RenderScene& scene);

}  // namespace flatspeckle::bench
