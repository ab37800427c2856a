#include "grin/rays/surfaces/mesh_surface.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <sstream>
#include <string>

#include "core/error.h"
#include "grin/rays/surfaces/mesh_distance.h"

namespace flatspeckle::grin {

namespace {

/// Nodes beyond the box of a mesh, and spacings that distances are known to.
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
    text << "is too fine: distances from the mesh would be asked for at " << nodes << " nodes, and "
         << most << " are the most";
    throw InputError(key, spacing, text.str());
  }
  NodeGrid grid{box.low - Vec3::Constant(padding * spacing), spacing, {}};
  for (int a = 0; a < 3; ++a) grid.nodes[a] = static_cast<int>(cells[a]) + 2 * padding + 1;
  return grid;
}

/// Signs by the winding number, where the node before in a row does not tell: a row begins outside,
/// and what is farther than a spacing from the surface is on the same side as the next node.
std::vector<double> signed_distances(const NodeGrid& grid, const TriangleMesh& mesh) {
  const MeshDistance exact(mesh);
  const double near = 1.001 * grid.spacing;
  std::vector<double> distances(grid.number(grid.nodes[0], 0, 0));
  for (int i = 0; i < grid.nodes[0]; ++i)
    for (int j = 0; j < grid.nodes[1]; ++j) {
      double before = std::numeric_limits<double>::infinity();
      for (int k = 0; k < grid.nodes[2]; ++k) {
        const Vec3 x = grid.origin + grid.spacing * Vec3(i, j, k);
        const double away = exact.unsigned_distance(x, padding * grid.spacing);
        const bool inside = std::abs(before) > near ? before < 0 : exact.winding_number(x) > 0.5;
        before = distances[grid.number(i, j, k)] = inside ? -away : away;
      }
    }
  return distances;
}

/// Of splines that are the distances at the nodes but for fourth derivatives.
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
        const double bend = d(-1, 0, 0) + d(1, 0, 0) + d(0, -1, 0) + d(0, 1, 0) + d(0, 0, -1) +
                            d(0, 0, 1) - 6 * d(0, 0, 0);
        coefficients[grid.number(i, j, k)] -= bend / 6;
      }
  return coefficients;
}

double volume_change(const LevelSurface& surface) {
  return surface.volume() / surface.meant_volume() - 1;
}

void check_volume(const LevelSurface& surface) {
  constexpr double most = 0.05;
  const double change = volume_change(surface);
  if (std::abs(change) <= most) return;
  std::ostringstream text;
  text << "the smooth surface would hold " << 100 * std::abs(change) << " % "
       << (change < 0 ? "less" : "more") << " than the mesh";
  throw InputError(text.str());
}

}  // namespace

LevelSurface mesh_surface(const TriangleMesh& mesh, double spacing, const std::string& key) {
  const NodeGrid grid = grid_around(bounds(mesh), spacing, key);
  try {
    const LevelSurface surface(grid.origin, spacing, grid.nodes,
                               spline_coefficients(grid, signed_distances(grid, mesh)),
                               volume(mesh));
    check_volume(surface);
    return surface;
  } catch (const InputError& error) {
    throw InputError(key, spacing, std::string("is too coarse: ") + error.what());
  }
}

LevelSurface mesh_surface(const TriangleMesh& mesh, const std::string& key) {
  constexpr double few_cells = 64, most_cells = 256, right = 0.01;
  const Box box = bounds(mesh);
  const double longest = (box.high - box.low).maxCoeff();
  for (double cells = few_cells; cells < most_cells; cells *= 2) {
    try {
      const LevelSurface surface = mesh_surface(mesh, longest / cells, key);
      if (std::abs(volume_change(surface)) < right) return surface;
    } catch (const InputError&) {  // too coarse
    }
  }
  return mesh_surface(mesh, longest / most_cells, key);
}

}  // namespace flatspeckle::grin
