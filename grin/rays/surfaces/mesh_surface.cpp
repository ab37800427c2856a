#include "grin/rays/surfaces/mesh_surface.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <sstream>
#include <string>
#include <utility>

#include "core/error.h"
#include "core/run/parallel.h"
#include "grin/media/geometry/vector_values.h"
#include "grin/rays/surfaces/mesh_distance.h"

namespace flatspeckle::grin {

namespace {

/// Number of grid nodes beyond the box of a mesh, on each side. Distances are computed up to this
/// number of spacings from the mesh.
constexpr int padding = 4;

struct NodeGrid {
  Vec3 origin;
  double spacing;
  std::array<int, 3> nodes;

  std::size_t number(int i, int j, int k) const {
    return (static_cast<std::size_t>(i) * nodes[1] + j) * nodes[2] + k;
  }
};

NodeGrid grid_around(const Box& box, double spacing, const std::string& key) {
  constexpr double most = 2e7, least = 1e-9;
  const double farthest = box.low.cwiseAbs().cwiseMax(box.high.cwiseAbs()).maxCoeff();
  if (!(spacing > least * farthest))
    throw InputError(key, spacing, "is too fine for coordinates as large as those of the mesh");
  const Vec3 cells = ((box.high - box.low) / spacing).array().ceil();
  const double nodes = (cells + Vec3::Constant(2 * padding + 1)).prod();
  if (!(nodes <= most)) {
    std::ostringstream text;
    text << "is too fine: the grid would have " << nodes << " nodes, at most " << most
         << " are allowed";
    throw InputError(key, spacing, text.str());
  }
  NodeGrid grid{box.low - Vec3::Constant(padding * spacing), spacing, {}};
  for (int a = 0; a < 3; ++a) grid.nodes[a] = static_cast<int>(cells[a]) + 2 * padding + 1;
  return grid;
}

/// Whether a point is inside a mesh, given the winding number of the mesh about it. Throws
/// OverlapError if the winding number is neither 0 nor 1, unless the point is close to the surface.
bool is_inside(double winding, double away, const NodeGrid& grid, const Vec3& x) {
  const bool is_clear = away > 1e-3 * grid.spacing;
  if (is_clear && winding > 1.5)
    throw OverlapError("parts of the surface overlap or lie inside one another, as at " +
                       listed(x) +
                       ": merge them into one surface (triangles around a cavity face into it)");
  if (is_clear && winding < -0.5)
    throw OverlapError("a part of the surface is turned inside out, as at " + listed(x));
  return winding > 0.5;
}

/// Returns the signed distances at the nodes. A node farther than a spacing from the surface is on
/// the same side as the next node of its row, and a row begins outside; elsewhere the sign follows
/// from the winding number.
std::vector<double> signed_distances(const NodeGrid& grid, const TriangleMesh& mesh) {
  const MeshDistance exact(mesh);
  const double near = 1.001 * grid.spacing;
  std::vector<double> distances(grid.number(grid.nodes[0], 0, 0));
  parallel_for(static_cast<std::size_t>(grid.nodes[0]), [&](std::size_t row) {
    const auto i = static_cast<int>(row);
    for (int j = 0; j < grid.nodes[1]; ++j) {
      double before = std::numeric_limits<double>::infinity();
      for (int k = 0; k < grid.nodes[2]; ++k) {
        const Vec3 x = grid.origin + grid.spacing * Vec3(i, j, k);
        const double away = exact.unsigned_distance(x, padding * grid.spacing);
        const bool inside = std::abs(before) > near
                                ? before < 0
                                : is_inside(exact.winding_number(x), away, grid, x);
        before = distances[grid.number(i, j, k)] = inside ? -away : away;
      }
    }
  });
  return distances;
}

/// Returns the coefficients of splines that reproduce the distances at the nodes, with errors of
/// the order of fourth derivatives.
std::vector<double> spline_coefficients(const NodeGrid& grid,
                                        const std::vector<double>& distances) {
  std::vector<double> coefficients = distances;
  const auto& nodes = grid.nodes;
  for (int i = 1; i + 1 < nodes[0]; ++i)
    for (int j = 1; j + 1 < nodes[1]; ++j)
      for (int k = 1; k + 1 < nodes[2]; ++k) {
        const auto d = [&](int di, int dj, int dk) {
          return distances[grid.number(i + di, j + dj, k + dk)];
        };
        const double laplacian = d(-1, 0, 0) + d(1, 0, 0) + d(0, -1, 0) + d(0, 1, 0) + d(0, 0, -1) +
                                 d(0, 0, 1) - 6 * d(0, 0, 0);
        coefficients[grid.number(i, j, k)] -= laplacian / 6;
      }
  return coefficients;
}

void check_volume(const LevelSurface& surface) {
  constexpr double most = 0.05;
  const double change = surface.volume() / surface.meant_volume() - 1;
  if (std::abs(change) <= most) return;
  std::ostringstream text;
  text << "the smooth surface would enclose " << 100 * std::abs(change) << " % "
       << (change < 0 ? "less" : "more") << " than the mesh";
  throw InputError(text.str());
}

}  // namespace

LevelSurface mesh_surface(const TriangleMesh& mesh, double spacing, const std::string& key) {
  const NodeGrid grid = grid_around(bounds(mesh), spacing, key);
  const std::vector<double> distances = signed_distances(grid, mesh);
  try {
    const LevelSurface surface(grid.origin, spacing, grid.nodes,
                               spline_coefficients(grid, distances), volume(mesh));
    check_volume(surface);
    return surface;
  } catch (const InputError& error) {
    throw InputError(key, spacing, std::string("is too coarse: ") + error.what());
  }
}

}  // namespace flatspeckle::grin
