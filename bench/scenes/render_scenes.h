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

/// Tissue under air (mu_s 10/mm, mu_a 0.02/mm, g 0.9, index 1.37) that a thin beam enters, with a
/// disk of radius 1.5 mm at this distance from it.
grin::RenderScene tissue_disk(double distance);
/// Power on this disk as a fraction of that of the beam, by harmonics at each transverse frequency
/// (reflectance), to 1e-3, for distances 20, 30 and 60.
double power_on_tissue_disk(double distance);

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
