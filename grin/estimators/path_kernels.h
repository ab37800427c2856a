#pragma once

#include <functional>
#include <memory>
#include <vector>

#include "core/numbers/random.h"
#include "grin/curved/curved_space.h"
#include "grin/paths/film.h"
#include "grin/paths/join_promises.h"
#include "grin/paths/transport.h"
#include "grin/space/render_plan.h"

namespace flatspeckle::grin {

/// Light paths and as many sensor paths, added to a film; with `promises`, what each pair promised
/// to add (Bidirectional) is collected too.
using PathKernel = std::function<void(int paths, RandomStream& random, Film& film,
                                      TransportCounts& counts, JoinPromises* promises)>;

/// Estimators compiled for a plan. The transport may still change before they are called.

/// Index 1 + excess in the part that the field fills.
PathKernel straight_kernel(const RenderPlan& plan, std::shared_ptr<const Transport> transport,
                           double excess);

/// random_phase: each light path and its sensor path meet their own phase of the sound.
PathKernel curved_kernel(const RenderPlan& plan, std::shared_ptr<const Transport> transport,
                         std::shared_ptr<const CurvedSpace> space, bool random_phase);

}  // namespace flatspeckle::grin
