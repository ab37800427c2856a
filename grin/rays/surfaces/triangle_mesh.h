#pragma once

#include <array>
#include <filesystem>
#include <string>
#include <vector>

#include "grin/media/geometry/shapes.h"

namespace flatspeckle::grin {

/// A closed surface of triangles: corners, and three of their numbers for each triangle,
/// anticlockwise seen from outside.
struct TriangleMesh {
  std::vector<Vec3> corners;
  std::vector<std::array<int, 3>> triangles;
};

/// Of triangles that are given by three corners each: equal corners become one, triangles without
/// an area go, and if they enclose a negative volume all are turned over. Throws InputError for a
/// corner that is not finite or beyond 1e50, no triangle, and for a surface that is not closed:
/// each edge must be passed as often one way as the other.
TriangleMesh closed_mesh(const std::vector<Vec3>& corners);

Box bounds(const TriangleMesh& mesh);
double volume(const TriangleMesh& mesh);
double area(const TriangleMesh& mesh);

/// The triangles of an STL file, binary or text, made closed_mesh(); the normals in it are not
/// read. Every InputError names the key and the file.
TriangleMesh read_stl(const std::string& key, const std::filesystem::path& path);

}  // namespace flatspeckle::grin
