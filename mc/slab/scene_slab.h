#pragma once

#include "flatland/scene/scene.h"
#include "mc/slab/adding/slab.h"

namespace flatspeckle::mc {

/// Makes the slab of a scene. If the scene has Layers, each becomes a layer of the slab; at least
/// one must scatter. delay: FieldChange::delay, which is multiplied by the diffusion factor of each
/// layer.
template <typename Geometry>
SlabOf<Geometry, double> slab_of(const Scene& scene, double delay = 0);

}  // namespace flatspeckle::mc
