#pragma once

#include <array>
#include <filesystem>
#include <string>
#include <vector>

#include "core/error.h"
#include "grin/media/geometry/shapes.h"
#include "grin/rays/surfaces/level_surface.h"

namespace flatspeckle::grin {

/// A closed surface of triangles: corners, and three of their numbers for each triangle,
/// anticlockwise seen from outside.
struct TriangleMesh {
  std::vector<Vec3> corners;
  std::vector<std::array<int, 3>> triangles;
};

/// Makes a mesh of triangles that are given by three corners each. Equal corners become one; where
/// the surface closes only so, also those within 1e-5 of its size. Triangles without an area go,
/// and those back to back; if the others enclose a negative volume all are turned over. Throws
/// InputError for a corner that is not finite or beyond 1e50, no triangle, no volume, and for a
/// surface that is not closed: each edge must be passed as often one way as the other.
TriangleMesh closed_mesh(const std::vector<Vec3>& corners);

Box bounds(const TriangleMesh& mesh);
double volume(const TriangleMesh& mesh);
double area(const TriangleMesh& mesh);

/// Reads the triangles of an STL file, binary or text, into a closed_mesh(); the normals in it are
/// not read. Every InputError names the key and the file.
TriangleMesh read_stl(const std::string& key, const std::filesystem::path& path);

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

/// A mesh whose parts lie in or over one another, or are turned inside out.
struct OverlapError : InputError {
  using InputError::InputError;
};

/// A smooth surface in place of a mesh, of cubic B-splines of the mesh's signed distances at the
/// nodes of a grid: planes stay as they are, spheres are off by the fourth power of the spacing,
/// and edges are rounded over one spacing, beside which faces swell by a twentieth of it. Throws
/// InputError, naming `key` of the spacing, where that is so large that 5 % of the volume would be
/// lost or won, or so small that the grid would have more than 2e7 nodes; and OverlapError.
LevelSurface mesh_surface(const TriangleMesh& mesh, double spacing, const std::string& key);

/// The same with a spacing of 1/64 of the longest side, or 1/128 or 1/256 where it takes that for
/// the volume to be right to 1 %, as of thin plates.
LevelSurface mesh_surface(const TriangleMesh& mesh, const std::string& key);

}  // namespace flatspeckle::grin
