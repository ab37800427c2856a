#pragma once

#include <optional>

#include "flatland/scene/scene.h"

namespace flatspeckle {

/// That which the key index_field names; none where the index is the same everywhere. Reads its
/// keys and the file of blobs. Throws InputError.
std::optional<IndexField> index_field(const Keys& keys, const SceneSpec& spec);

/// Throws InputError where a scene cannot have the field that it has: what scatters, the domain,
/// and n^2 wherever light goes.
void check_index_field(const Scene& scene);

/// Throws InputError where the index varies, which `what` does not take.
void refuse_graded(const Scene& scene, const std::string& what);

}  // namespace flatspeckle
