#pragma once

#include "grin/rays/surfaces/triangle_mesh.h"

namespace flatspeckle::grin {

/// Distances to the triangles of a mesh through a tree of boxes.
class MeshDistance {
 public:
  explicit MeshDistance(const TriangleMesh& mesh);

  /// To the nearest triangle, >= 0, or `bound` where that is farther.
  double unsigned_distance(const Vec3& x, double bound) const;

  /// Times that the mesh goes round x, 1 inside and 0 outside a closed mesh (Van Oosterom and
  /// Strackee 1983); what is far away counts as one facet, to some hundredths (Barill, Dickson,
  /// Schmidt, Levin and Jacobson 2018).
  double winding_number(const Vec3& x) const;

 private:
  struct Triangle {
    Vec3 a, b, c;
  };
  struct Node {
    Vec3 low, high;
    int begin, end;  ///< triangles, of a leaf
    int left = -1, right = -1;
    Vec3 area = Vec3::Zero(), middle = Vec3::Zero();  ///< summed, and the mean by area
    double radius = 0;                                ///< about the middle
  };
  int build(int begin, int end);
  void add_up(Node& node) const;
  void nearest(int node, const Vec3& x, double& squared) const;
  double solid_angle(int node, const Vec3& x) const;

  std::vector<Triangle> triangles_;
  std::vector<Node> nodes_;
};

}  // namespace flatspeckle::grin
