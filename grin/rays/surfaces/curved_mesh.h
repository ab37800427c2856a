#pragma once

#include <array>
#include <vector>

#include "grin/rays/surfaces/triangle_mesh.h"

namespace flatspeckle::grin {

/// A mesh whose triangles have been replaced by curved patches, which are divided into small
/// triangles.
struct CurvedMesh {
  TriangleMesh mesh;
  double given_volume;  ///< volume of the mesh before its triangles were curved
  std::vector<std::array<Vec3, 2>> creases = {};  ///< ends of the edges that stay sharp
  double largest_bend = 0;  ///< largest angle between the normals of neighbours that became smooth
};

/// Curves the triangles of a closed mesh. Each becomes a cubic patch that contains its corners and
/// is perpendicular to their normals [vlachos2001]. The normal of a corner is the weighted mean
/// over its triangles that is exact for spheres [max1999]. An edge whose two triangles have normals
/// more than `crease` apart, in radians, stays sharp, but is curved along the surfaces that it
/// separates. Plane faces stay plane. longest: largest side of the small triangles; a patch that is
/// plane is not divided. With crease = 0 the mesh is unchanged.
CurvedMesh curved_mesh(const TriangleMesh& mesh, double crease, double longest);

}  // namespace flatspeckle::grin
