#pragma once

#include <array>
#include <filesystem>
#include <string>
#include <vector>

#include "core/error.h"
#include "grin/media/geometry/shapes.h"
#include "grin/rays/surfaces/level_surface.h"

namespace flatspeckle::grin {

/// A closed surface of triangles: corners, and three indices of corners for each triangle,
/// anticlockwise seen from outside.
struct TriangleMesh {
  std::vector<Vec3> corners;
  std::vector<std::array<int, 3>> triangles;
};

/// Makes a mesh of triangles given by three corners each. Equal corners are merged. If the surface
/// is not closed after that, corners within 1e-5 of its size of each other are also merged.
/// Triangles without area and pairs that lie back to back are removed. If the remaining triangles
/// enclose a negative volume, all are reversed. Throws InputError if a corner is not finite or
/// beyond 1e50, if there is no triangle or no volume, or if the surface is not closed: each edge
/// must be passed equally often in both directions.
TriangleMesh closed_mesh(const std::vector<Vec3>& corners);

Box bounds(const TriangleMesh& mesh);
double volume(const TriangleMesh& mesh);
double area(const TriangleMesh& mesh);

/// Reads the triangles of an STL file, binary or text, and makes a closed_mesh() of them. Ignores
/// the normals in the file. Every InputError names the key and the file.
TriangleMesh read_stl(const std::string& key, const std::filesystem::path& path);

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

/// Error of a mesh whose parts overlap, lie inside one another or are turned inside out.
struct OverlapError : InputError {
  using InputError::InputError;
};

/// Returns a smooth surface that approximates a mesh. It consists of cubic B-splines, computed from
/// the signed distances from the mesh at the nodes of a grid. Planes are exact, and the error of
/// spheres is proportional to the fourth power of the spacing. Edges are rounded over one spacing;
/// next to an edge, faces swell by 1/20 of the spacing. Throws an InputError that names `key`, the
/// key of the spacing, if the spacing is so large that the volume would change by 5 %, or so small
/// that the grid would have more than 2e7 nodes. Throws OverlapError for a mesh whose parts
/// overlap.
LevelSurface mesh_surface(const TriangleMesh& mesh, double spacing, const std::string& key);

/// Returns a smooth surface with a grid spacing of 1/64 of the longest side of the mesh. If its
/// volume is not accurate to 1 %, for example for thin plates, uses 1/128 or 1/256.
LevelSurface mesh_surface(const TriangleMesh& mesh, const std::string& key);

}  // namespace flatspeckle::grin
