#pragma once

#include <array>
#include <optional>
#include <vector>

#include "grin/media/geometry/shapes.h"

namespace flatspeckle::grin {

/// A closed surface of triangles: corners, and three indices of corners for each triangle,
/// anticlockwise seen from outside.
struct TriangleMesh {
  std::vector<Vec3> corners;
  std::vector<std::array<int, 3>> triangles;
  /// Number of triangles that were given clockwise, against most of their part of the surface.
  std::size_t turned = 0;
};

/// Makes a mesh of triangles given by three corners each. Equal corners are merged. If the surface
/// is not closed after that, corners within `weld` of each other are also merged (default: 1e-5 of
/// the size of the mesh). Triangles without area and pairs that lie back to back are removed.
/// Triangles whose orientation contradicts that of their neighbours are reversed, as are parts that
/// are inside out and not cavities. Throws InputError if a corner is not finite or beyond 1e50, if
/// there is no triangle or no volume, or if the surface has a hole: each edge must be passed
/// equally often in both directions.
TriangleMesh closed_mesh(const std::vector<Vec3>& corners, std::optional<double> weld = {});

Box bounds(const TriangleMesh& mesh);
double volume(const TriangleMesh& mesh);
double area(const TriangleMesh& mesh);
/// Returns the vector normal to a triangle whose length is twice the area of the triangle.
Vec3 doubled_area(const TriangleMesh& mesh, const std::array<int, 3>& triangle);

}  // namespace flatspeckle::grin
