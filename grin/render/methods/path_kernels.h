#pragma once

#include <functional>
#include <memory>
#include <vector>

#include "core/numbers/random.h"
#include "grin/render/flights/space.h"
#include "grin/render/stage/render_plan.h"
#include "grin/render/transport/film.h"
#include "grin/render/transport/join_promises.h"
#include "grin/render/transport/transport.h"

namespace flatspeckle::grin {

/// Light paths and as many sensor paths, added to a film; with `promises`, what each pair promised
/// to add (Bidirectional) is collected too.
using PathKernel = std::function<void(int paths, RandomStream& random, Film& film,
                                      TransportCounts& counts, JoinPromises* promises)>;

/// plan: whether light is split (deep). The transport may still change before the kernel is called.
/// random_phase: each light path and its sensor path meet their own phase of the sound.
PathKernel path_kernel(const RenderPlan& plan, std::shared_ptr<const Transport> transport,
                       std::shared_ptr<const Space> space, bool random_phase = false);

}  // namespace flatspeckle::grin
