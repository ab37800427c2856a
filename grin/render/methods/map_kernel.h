#pragma once

#include <functional>
#include <memory>

#include "core/numbers/complex.h"
#include "grin/render/flights/space.h"
#include "grin/render/methods/light_map.h"
#include "grin/render/transport/transport.h"

namespace flatspeckle::grin {

/// Adds so many light paths to the sums of a map: [cell][fluence rate, absorbed power density], and
/// what became of their power. Each stretch of a path counts by its length in a cell (track-length
/// estimator), which points along it find.
using MapKernel = std::function<void(int paths, RandomStream& random, std::span<Complex> sums,
                                     EnergyBalance& energy, TransportCounts& counts)>;
inline constexpr std::size_t sums_per_cell = 2;

/// random_phase: each light path meets its own phase of the sound.
MapKernel map_kernel(const LightMap& map, std::shared_ptr<const Transport> transport,
                     std::shared_ptr<const Space> space, bool random_phase);

}  // namespace flatspeckle::grin
