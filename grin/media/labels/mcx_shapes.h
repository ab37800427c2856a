#pragma once

#include <filesystem>

#include "grin/media/labels/label_volume.h"

namespace flatspeckle::grin {

/// Returns the voxels that the shapes of an MCX scene [fang2009] fill. A later shape replaces an
/// earlier one. A voxel belongs to a shape if its middle does. Throws InputError for a shape
/// without counterpart.
LabelVolume read_mcx_shapes(const std::filesystem::path& path);

}  // namespace flatspeckle::grin
