#pragma once

#include "grin/render/methods/tracer.h"

namespace flatspeckle::grin {

/// Whether a method has finite variance in this scene. Path tracing connects to point lights and
/// fibres, and, where the index varies, to beams. These contributions grow as 1/r^2 at short
/// distance r, and no other strategy competes, so that their variance is infinite if paths scatter
/// near the light. For the same reason light tracing to a pinhole in a scattering medium has
/// infinite variance.
bool has_finite_variance(const RenderScene& scene, RenderMethod method);

/// Returns the method with the least work (variance per pixel times number of flights) according to
/// a pilot run. The result depends only on the scene, not on the seed; the work of the pilot is
/// bounded.
Tracer best_tracer(const Tracers& tracers);

}  // namespace flatspeckle::grin
