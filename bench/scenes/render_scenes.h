#pragma once

#include <string>
#include <vector>

#include "grin/render/pictures/render_job.h"

namespace flatspeckle::bench {

struct NamedRender {
  std::string name;
  grin::RenderScene scene;
};

/// A medium with Henyey-Greenstein scattering.
grin::ScatteringMedium fog(double mu_s, double mu_a, double g);

/// The ultrasonic waveguide in tissue: data/scenes/render_waveguide.toml with fewer pixels and
/// lengths in mm.
grin::RenderScene waveguide();

/// Scenes in which one part of the boundary is the lamp and another the detector (8 x 8 pixels of
/// irradiance), so that rays can hit both: the Luneburg ball, the waveguide, a slab of five mean
/// free paths with straight rays, and a glass ball in fog.
std::vector<NamedRender> lamp_scenes();
/// The Luneburg ball in isotropic illumination.
grin::RenderScene even_luneburg();
/// Nested and adjacent balls in isotropic illumination.
grin::RenderScene even_balls();
/// A ring of triangles that contains fog with its own index.
grin::RenderScene even_ring();
/// The glass ball in fog under a beam, viewed from the side.
grin::RenderScene beam_on_glass_ball();

}  // namespace flatspeckle::bench
