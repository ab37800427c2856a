#pragma once

#include <string>
#include <vector>

#include "grin/render_job.h"

namespace flatspeckle::bench {

struct NamedRender {
  std::string name;
  grin::RenderScene scene;
};

/// The scattering Luneburg ball under a beam, seen from the side, and the ultrasonic waveguide in
/// tissue (813 kHz, 3 mean free paths, g = 0.85): data/scenes/render_luneburg.toml and
/// render_waveguide.toml with fewer pixels. Lengths in mm. And a Luneburg ball that is the whole
/// stage, with beam and pinhole within it.
std::vector<NamedRender> render_scenes();

/// The general straight scene and its parts, for the table of what a plan leaves out.
grin::RenderScene foggy_ball();

}  // namespace flatspeckle::bench
