#pragma once

#include <vector>

#include "grin/rays/surfaces/triangle_mesh.h"

namespace flatspeckle::grin {

/// Computes distances to the triangles of a mesh by a tree of boxes.
class MeshDistance {
 public:
  explicit MeshDistance(const TriangleMesh& mesh);

  /// Returns the distance to the nearest triangle, >= 0, or `bound` if that is smaller.
  double unsigned_distance(const Vec3& x, double bound) const;

  /// Returns the winding number of the mesh about x [vanoosterom1983]: 1 inside a closed mesh, 0
  /// outside. Distant nodes of the tree count as one facet, with an error of a few hundredths
  /// [barill2018].
  double winding_number(const Vec3& x) const;

 private:
  struct Triangle {
    Vec3 a, b, c;
  };
  struct Node {
    Vec3 low, high;
    int begin, end;  ///< triangles from begin to end - 1
    int left = -1, right = -1;
    Vec3 area = Vec3::Zero(), middle = Vec3::Zero();  ///< area vector; area-weighted centre
    double radius = 0;  ///< radius of a sphere about `middle` that contains the triangles
  };
  int build(int begin, int end);
  void add_up(Node& node) const;
  void nearest(int node, const Vec3& x, double& squared) const;
  double solid_angle(int node, const Vec3& x) const;

  std::vector<Triangle> triangles_;
  std::vector<Node> nodes_;
};

}  // namespace flatspeckle::grin
