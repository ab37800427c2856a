#include "grin/surfaces/distance_grid.h"

#include <algorithm>
#include <cmath>

#include "core/error.h"
#include "grin/geometry/vector_values.h"
#include "grin/surfaces/mesh_distance.h"

namespace flatspeckle::grin {

namespace {

constexpr int padding = 2;  ///< cells beyond the mesh's box

void check(const TriangleMesh& mesh, int cells) {
  if (mesh.triangles.empty()) throw InputError("triangles of a mesh", 0, "at least one");
  if (cells < 2) throw InputError("cells of a distance grid", cells, "at least 2");
  for (const Vec3& corner : mesh.corners)
    if (!corner.allFinite()) throw InputError("corner of a mesh", listed(corner), "must be finite");
  for (const auto& triangle : mesh.triangles)
    for (const int corner : triangle)
      if (corner < 0 || corner >= static_cast<int>(mesh.corners.size()))
        throw InputError("corner number of a triangle", corner, "must be one of the mesh");
}

}  // namespace

DistanceGrid::DistanceGrid(const TriangleMesh& mesh, int cells) {
  check(mesh, cells);
  Vec3 low = mesh.corners[mesh.triangles[0][0]], high = low;
  for (const auto& triangle : mesh.triangles)
    for (const int corner : triangle) {
      low = low.cwiseMin(mesh.corners[corner]);
      high = high.cwiseMax(mesh.corners[corner]);
    }
  spacing_ = (high - low).maxCoeff() / cells;
  if (!(spacing_ > 0)) throw InputError("size of a mesh", 0, "must be positive");
  low_ = low - Vec3::Constant(padding * spacing_);
  for (int a = 0; a < 3; ++a)
    nodes_[a] = static_cast<int>(std::ceil((high - low)[a] / spacing_)) + 2 * padding + 1;
  const MeshDistance exact(mesh);
  values_.resize(static_cast<std::size_t>(nodes_[0]) * nodes_[1] * nodes_[2]);
  for (int i = 0; i < nodes_[0]; ++i) {
    for (int j = 0; j < nodes_[1]; ++j) {
      for (int k = 0; k < nodes_[2]; ++k) {
        const Vec3 x = low_ + spacing_ * Vec3(i, j, k);
        const double d = exact.unsigned_distance(x);
        // A row begins outside; farther than one spacing from the surface its next node is on the
        // same side.
        const double before = k > 0 ? values_[node(i, j, k - 1)] : 2 * spacing_;
        const bool inside =
            std::abs(before) > 1.001 * spacing_ ? before < 0 : exact.winding_number(x) > 0.5;
        values_[node(i, j, k)] = inside ? -d : d;
      }
    }
  }
  scale_to_lower_bound();
}

/// Differences along edges bound each component of the interpolant's slope in a cell.
void DistanceGrid::scale_to_lower_bound() {
  double steepest = spacing_ * spacing_;
  for (int i = 0; i + 1 < nodes_[0]; ++i) {
    for (int j = 0; j + 1 < nodes_[1]; ++j) {
      for (int k = 0; k + 1 < nodes_[2]; ++k) {
        const auto v = corner_values(node(i, j, k));
        double sum = 0;
        for (const int bit : {4, 2, 1}) {
          double most = 0;
          for (int corner = 0; corner < 8; ++corner)
            if (!(corner & bit)) most = std::max(most, std::abs(v[corner | bit] - v[corner]));
          sum += most * most;
        }
        steepest = std::max(steepest, sum);
      }
    }
  }
  const double scale = spacing_ / std::sqrt(steepest);
  for (double& value : values_) value *= scale;
}

std::array<double, 8> DistanceGrid::corner_values(std::size_t base) const {
  const std::size_t y = nodes_[2], x = y * nodes_[1];
  return {values_[base],         values_[base + 1],        values_[base + y],
          values_[base + y + 1], values_[base + x],        values_[base + x + 1],
          values_[base + x + y], values_[base + x + y + 1]};
}

Vec3 DistanceGrid::high() const {
  return low_ + spacing_ * Vec3(nodes_[0] - 1, nodes_[1] - 1, nodes_[2] - 1);
}

DistanceGrid::Cell DistanceGrid::cell(const Vec3& x) const {
  const Vec3 position = (x - low_) / spacing_;
  std::array<int, 3> c;
  for (int a = 0; a < 3; ++a)
    c[a] = static_cast<int>(std::clamp(std::floor(position[a]), 0.0, nodes_[a] - 2.0));
  return {node(c[0], c[1], c[2]), position - Vec3(c[0], c[1], c[2])};
}

double DistanceGrid::interpolated(const Vec3& x) const {
  const Cell at = cell(x);
  const auto v = corner_values(at.base);
  const auto mix = [](double a, double b, double t) { return a + t * (b - a); };
  const double near = mix(mix(v[0], v[1], at.t[2]), mix(v[2], v[3], at.t[2]), at.t[1]);
  const double far = mix(mix(v[4], v[5], at.t[2]), mix(v[6], v[7], at.t[2]), at.t[1]);
  return mix(near, far, at.t[0]);
}

double DistanceGrid::distance(const Vec3& x) const {
  const Vec3 nearest = x.cwiseMax(low_).cwiseMin(high());
  const double outside = (x - nearest).norm();
  if (outside == 0) return interpolated(x);
  // The mesh is the padding inside the grid, the zero level within a cell of it.
  return std::max(interpolated(nearest) - outside, outside + (padding - 1) * spacing_);
}

Vec3 DistanceGrid::normal(const Vec3& x) const {
  const Cell at = cell(x);
  const auto v = corner_values(at.base);
  Vec3 gradient = Vec3::Zero();
  for (int corner = 0; corner < 8; ++corner) {
    for (int axis = 0; axis < 3; ++axis) {
      double weight = 1;
      for (int other = 0; other < 3; ++other) {
        const bool upper = corner & (4 >> other);
        weight *= other == axis ? (upper ? 1 : -1) : (upper ? at.t[other] : 1 - at.t[other]);
      }
      gradient[axis] += weight * v[corner];
    }
  }
  return gradient.normalized();
}

}  // namespace flatspeckle::grin
