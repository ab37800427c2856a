#pragma once

#include "grin/surfaces/distance_grid.h"

namespace flatspeckle::grin {

/// Distances to the triangles of a mesh through a tree of boxes.
class MeshDistance {
 public:
  explicit MeshDistance(const TriangleMesh& mesh);

  /// To the nearest triangle, >= 0.
  double unsigned_distance(const Vec3& x) const;

  /// Times that the mesh goes round x, 1 inside and 0 outside a closed mesh (Van Oosterom and
  /// Strackee 1983). Visits all triangles.
  double winding_number(const Vec3& x) const;

 private:
  struct Triangle {
    Vec3 a, b, c;
  };
  struct Node {
    Vec3 low, high;
    int begin, end;  ///< triangles, of a leaf
    int left = -1, right = -1;
  };
  int build(int begin, int end);
  void nearest(int node, const Vec3& x, double& squared) const;

  std::vector<Triangle> triangles_;
  std::vector<Node> nodes_;
};

}  // namespace flatspeckle::grin
