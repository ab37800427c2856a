#pragma once

#include <string>
#include <vector>

#include "grin/render/pictures/render_job.h"

namespace flatspeckle::bench {

struct NamedRender {
  std::string name;
  grin::RenderScene scene;
};

/// The scattering Luneburg ball with its pencils of light and the ultrasonic waveguide in tissue:
/// data/scenes/render_luneburg.toml and render_waveguide.toml with fewer pixels. And two that suit
/// a photon map better: a wide beam, smooth from pixel to pixel, and a ball seen from outside,
/// whose surface no join crosses. Lengths in mm.
std::vector<NamedRender> render_scenes();

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

/// The general straight scene and its parts, for the table of what a plan leaves out.
grin::RenderScene foggy_ball();

}  // namespace flatspeckle::bench
