#pragma once

#include <functional>
#include <memory>

#include "flatland/scene/scene.h"

namespace flatspeckle {

/// Makes a density map of a box of a material.
using MakeDensityMap =
    std::function<std::shared_ptr<const MediumProfile>(const Domain&, const Material&)>;

/// That which the keys density_blobs and density_map name; empty without. Reads keys and files.
/// Throws InputError.
MakeDensityMap density_map(const Keys& keys, const SceneSpec& spec);

}  // namespace flatspeckle
