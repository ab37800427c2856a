#pragma once

#include "grin/surfaces/distance_grid.h"

namespace flatspeckle::grin::tests {

/// [-half, half]^3.
inline TriangleMesh cube_mesh(double half) {
  TriangleMesh mesh;
  for (int i = 0; i < 8; ++i)
    mesh.corners.push_back(half * Vec3(i & 1 ? 1 : -1, i & 2 ? 1 : -1, i & 4 ? 1 : -1));
  mesh.triangles = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                    {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
  return mesh;
}

}  // namespace flatspeckle::grin::tests
