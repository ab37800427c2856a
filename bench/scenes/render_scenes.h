#pragma once

#include <string>
#include <vector>

#include "grin/render/pictures/render_job.h"

namespace flatspeckle::bench {

struct NamedRender {
  std::string name;
  grin::RenderScene scene;
};

/// Henyey-Greenstein.
grin::ScatteringMedium fog(double mu_s, double mu_a, double g);

/// The ultrasonic waveguide in tissue: data/scenes/render_waveguide.toml with fewer pixels, in mm.
grin::RenderScene waveguide();

/// Lit by a part of the boundary and seen by another (8 x 8 pixels of irradiance), which rays can
/// hit: the Luneburg ball, the waveguide, a slab of five mean free paths with straight rays, and a
/// glass ball in fog.
std::vector<NamedRender> lamp_scenes();
/// The Luneburg ball in even light from everywhere.
grin::RenderScene even_luneburg();
/// Balls in each other and side by side, in the same light.
grin::RenderScene even_balls();
/// A ring of triangles, of fog with an index of its own.
grin::RenderScene even_ring();
/// The glass ball in fog under a beam, seen from the side.
grin::RenderScene beam_on_glass_ball();

}  // namespace flatspeckle::bench
