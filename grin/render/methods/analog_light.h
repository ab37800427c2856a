#pragma once

#include "grin/render/methods/moving_field.h"
#include "grin/render/methods/path_kernels.h"
#include "grin/render/methods/sensor_aim.h"

namespace flatspeckle::grin {

/// Light paths that are counted where they hit sensors, and never joined to anything: each costs
/// little, and none is worth much more than its power. With an aim they are split where they head
/// for the sensors, and most that do not are given up. Of a space with lanes side by side; each
/// path has random numbers of its own. Unscattered light of beams is left out
/// (unscattered_beams.h). moving: the field of the space, where there are derivatives by its
/// parameters.
PathKernel analog_kernel(std::shared_ptr<const Transport> transport,
                         std::shared_ptr<const Space> space, std::optional<SensorAim> aim,
                         bool random_phase, std::shared_ptr<const MovingField> moving = nullptr);

}  // namespace flatspeckle::grin
