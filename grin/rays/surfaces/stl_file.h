#pragma once

#include <filesystem>
#include <string>

#include "grin/rays/surfaces/triangle_mesh.h"

namespace flatspeckle::grin {

/// The triangles of an STL file, binary or text, made closed_mesh(); the normals in it are not
/// read. Every InputError names the key and the file.
TriangleMesh read_stl(const std::string& key, const std::filesystem::path& path);

}  // namespace flatspeckle::grin
