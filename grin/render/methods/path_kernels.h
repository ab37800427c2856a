#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "core/numbers/random.h"
#include "grin/render/flights/space.h"
#include "grin/render/transport/film.h"
#include "grin/render/transport/transport.h"
#include "grin/render/transport/transport_counts.h"

namespace flatspeckle::grin {

/// What light transport in a scene has to do; stored with the result. Leaving out what a scene does
/// not need never changes a result beyond rounding.
struct RenderPlan {
  bool curved = true;    ///< the index changes from point to point, not only at surfaces of bodies
  bool scatters = true;  ///< some medium does
  bool absorbs = true;   ///< some medium does; all that scatters is lossless without
  bool gridded = true;   ///< some medium's density is a grid
  bool body = true;      ///< one or more in the stage
  bool timed = true;     ///< more than one bin of optical path
  bool deep = true;      ///< light is split on its way to sensors deep behind a medium

  bool operator==(const RenderPlan&) const = default;

  /// For people, and for the result file.
  std::string describe() const;
};

/// Light paths and as many sensor paths, added to a film; with `promises`, what each pair promised
/// to add (Bidirectional) is collected too.
using PathKernel = std::function<void(int paths, RandomStream& random, Film& film,
                                      TransportCounts& counts, JoinPromises* promises)>;

/// plan: whether light is split (deep). The transport may still change before the kernel is called.
/// random_phase: each light path and its sensor path meet their own phase of the sound.
PathKernel path_kernel(const RenderPlan& plan, std::shared_ptr<const Transport> transport,
                       std::shared_ptr<const Space> space, bool random_phase = false);

}  // namespace flatspeckle::grin
