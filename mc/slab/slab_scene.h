#pragma once

#include "flatland/scene/scene.h"
#include "mc/slab/adding/slab.h"

namespace flatspeckle::mc {

/// A scene's slab; of Layers, of which one at the least scatters, a layer each. delay: of
/// scatterers that diffuse as the scene states, of which each layer has its share.
template <typename Geometry>
SlabOf<Geometry, double> slab_of(const Scene& scene, double delay = 0);

}  // namespace flatspeckle::mc
