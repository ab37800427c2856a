#pragma once

#include "grin/render/methods/tracer.h"

namespace flatspeckle::grin {

/// Path tracing joins to points and fibres by 1/r^2 without another strategy beside, and where the
/// index varies to what beams light first; light tracing joins to pinholes so.
bool has_finite_variance(const RenderScene& scene, RenderMethod method);

/// Of path, light and bidirectional tracing that which draws the picture with the least work, as a
/// pilot has it: variance by pixel times flights. Of the scene alone, whatever the seed. Bounded in
/// work.
Tracer best_tracer(const Tracers& tracers);

}  // namespace flatspeckle::grin
