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

/// Features that light transport in a scene requires; stored with the result. Leaving out features
/// that a scene does not need changes a result only by rounding.
struct RenderPlan {
  bool curved = true;    ///< the index varies continuously, not only at surfaces of bodies
  bool scatters = true;  ///< some medium scatters
  bool absorbs = true;   ///< some medium absorbs
  bool gridded = true;   ///< some medium has a density grid
  bool body = true;      ///< the stage has one or more bodies
  bool timed = true;     ///< more than one bin of optical path
  bool deep = true;      ///< light is split by importance, for sensors deep behind a medium

  bool operator==(const RenderPlan&) const = default;

  /// Describes the plan, for the output and the result file.
  std::string describe() const;
};

/// Adds this number of light paths, and as many paths from each sensor, to a film.
/// expected_connections, if not null, receives the expected contributions of each pair
/// (Bidirectional).
using PathKernel =
    std::function<void(int paths, RandomStream& random, Film& film, TransportCounts& counts,
                       ExpectedConnections* expected_connections)>;

/// Makes the kernel of a plan. It splits light paths if the plan is deep. The transport may still
/// be changed before the kernel is called. random_phase: each pair of light path and sensor paths
/// has its own random phase of the sound.
PathKernel path_kernel(const RenderPlan& plan, std::shared_ptr<const Transport> transport,
                       std::shared_ptr<const Space> space, bool random_phase = false);

}  // namespace flatspeckle::grin
