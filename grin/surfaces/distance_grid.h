#pragma once

#include <array>
#include <span>
#include <vector>

#include "grin/geometry/vec3.h"

namespace flatspeckle::grin {

/// A closed surface of triangles: corners, and three of their numbers for each triangle,
/// anticlockwise seen from outside.
struct TriangleMesh {
  std::vector<Vec3> corners;
  std::vector<std::array<int, 3>> triangles;
};

/// Signed distance to a mesh on a grid of cubes, trilinear between the nodes: the surface that rays
/// see is its zero level, which is off the mesh by the square of the spacing over the radius of
/// curvature, and rounds edges over one spacing.
class DistanceGrid {
 public:
  /// `cells` of the longest side of the mesh's box; two more on each side. Distances are exact at
  /// the nodes, signs from the winding number, so that small holes do no harm. Throws InputError
  /// for an empty mesh, a corner that is not finite or not there, or fewer than 2 cells.
  DistanceGrid(const TriangleMesh& mesh, int cells);

  /// The interpolated distance, divided by its own steepest slope; outside the grid a lower bound.
  double distance(const Vec3& x) const;
  Vec3 normal(const Vec3& x) const;

  const Vec3& low() const { return low_; }
  Vec3 high() const;
  double spacing() const { return spacing_; }

 private:
  struct Cell {
    std::size_t base;
    Vec3 t;
  };
  Cell cell(const Vec3& x) const;
  double interpolated(const Vec3& x) const;
  std::size_t node(int i, int j, int k) const {
    return (static_cast<std::size_t>(i) * nodes_[1] + j) * nodes_[2] + k;
  }
  std::array<double, 8> corner_values(std::size_t base) const;
  void scale_to_lower_bound();

  Vec3 low_;
  double spacing_;
  std::array<int, 3> nodes_;
  std::vector<double> values_;
};

}  // namespace flatspeckle::grin
