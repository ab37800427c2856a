#include "grin/rays/surfaces/curved_mesh.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <utility>

#include <Eigen/Geometry>

namespace flatspeckle::grin {

namespace {

using Edge = std::pair<int, int>;

double angle_between(const Vec3& a, const Vec3& b) {
  return std::atan2(a.cross(b).norm(), a.dot(b));
}

/// Normals of a mesh. Corner i of triangle t is corner 3 t + i of the mesh; corners at one place
/// that are connected by smooth edges form a fan and share a normal.
class MeshNormals {
 public:
  MeshNormals(const TriangleMesh& mesh, double crease) : mesh_(mesh) {
    for (const auto& triangle : mesh.triangles)
      flat_.push_back(doubled_area(mesh, triangle).normalized());
    fan_.resize(3 * flat_.size());
    std::iota(fan_.begin(), fan_.end(), 0);
    find_sides();
    for (auto& [edge, side] : sides_) join_smooth(edge, side, crease);
    add_up();
  }

  const Vec3& at(int triangle, int i) const { return normals_[root(3 * triangle + i)]; }
  /// Whether the edge from corner i to corner i + 1 of a triangle is smooth.
  bool is_smooth(int triangle, int i) const { return sides_.at(key(triangle, i)).smooth; }
  /// Returns the normal on the other side of the edge at corner `at` of a triangle, which is one
  /// of the ends of the edge from corner i to corner i + 1.
  const Vec3& beyond(int triangle, int i, int at_corner) const {
    const Side& side = sides_.at(key(triangle, i));
    if (side.triangles.size() != 2) return at(triangle, at_corner);
    const int other = side.triangles[side.triangles[0] == triangle ? 1 : 0];
    return at(other, corner_of(other, mesh_.triangles[triangle][at_corner]));
  }
  double largest_bend() const { return largest_bend_; }
  std::vector<std::array<Vec3, 2>> creases() const {
    std::vector<std::array<Vec3, 2>> found;
    for (const auto& [edge, side] : sides_)
      if (!side.smooth) found.push_back({mesh_.corners[edge.first], mesh_.corners[edge.second]});
    return found;
  }

 private:
  struct Side {
    std::vector<int> triangles = {};
    bool smooth = false;
  };

  Edge key(int triangle, int i) const {
    const auto& corners = mesh_.triangles[triangle];
    return std::minmax(corners[i], corners[(i + 1) % 3]);
  }
  int corner_of(int triangle, int corner) const {
    const auto& corners = mesh_.triangles[triangle];
    return static_cast<int>(std::ranges::find(corners, corner) - corners.begin());
  }
  void find_sides() {
    for (int t = 0; t < static_cast<int>(flat_.size()); ++t)
      for (int i = 0; i < 3; ++i) sides_[key(t, i)].triangles.push_back(t);
  }
  int root(int corner) const {
    while (fan_[corner] != corner) corner = fan_[corner];
    return corner;
  }
  void join_smooth(const Edge& edge, Side& side, double crease) {
    if (side.triangles.size() != 2) return;
    const auto [t, u] = std::pair(side.triangles[0], side.triangles[1]);
    const double bend = angle_between(flat_[t], flat_[u]);
    side.smooth = bend <= std::max(crease, 1e-9);
    if (!side.smooth) return;
    largest_bend_ = std::max(largest_bend_, bend);
    for (const int corner : {edge.first, edge.second}) {
      const int from = root(3 * t + corner_of(t, corner)), to = root(3 * u + corner_of(u, corner));
      fan_[std::max(from, to)] = std::min(from, to);
    }
  }
  void add_up() {
    normals_.assign(fan_.size(), Vec3::Zero());
    for (int t = 0; t < static_cast<int>(flat_.size()); ++t)
      for (int i = 0; i < 3; ++i) {
        const auto corner = [&](int k) { return mesh_.corners[mesh_.triangles[t][(i + k) % 3]]; };
        const Vec3 a = corner(1) - corner(0), b = corner(2) - corner(0);
        normals_[root(3 * t + i)] += a.cross(b) / (a.squaredNorm() * b.squaredNorm());
      }
    for (Vec3& normal : normals_)
      if (normal.squaredNorm() > 0) normal.normalize();
  }

  const TriangleMesh& mesh_;
  std::vector<Vec3> flat_, normals_;
  std::vector<int> fan_;
  std::map<Edge, Side> sides_;
  double largest_bend_ = 0;
};

/// Cubic patch over a triangle, in the order of powers of the barycentric coordinates (u, v, w).
struct Patch {
  std::array<Vec3, 3> corners;
  /// Control points beside corner i on the way to corner i + 1, and on the way to corner i + 2.
  std::array<Vec3, 3> ahead, back;
  Vec3 middle;

  Vec3 at(double u, double v, double w) const {
    const std::array<double, 3> c{u, v, w};
    Vec3 x = 6 * u * v * w * middle;
    for (int i = 0; i < 3; ++i) {
      const double p = c[i];
      x += p * p * (p * corners[i] + 3 * c[(i + 1) % 3] * ahead[i] + 3 * c[(i + 2) % 3] * back[i]);
    }
    return x;
  }
};

/// Returns the control point beside `from` of a curved edge towards `to`. The edge starts
/// perpendicular to the normals of both adjacent surfaces, and is exact to fifth order for arcs of
/// circles.
Vec3 control_point(const Vec3& from, const Vec3& to, const Vec3& normal, const Vec3& beyond) {
  constexpr double parallel = 1e-3;
  const Vec3 chord = to - from, along = normal.cross(beyond);
  const double length = chord.norm();
  const Vec3 tangent = along.norm() > parallel
                           ? Vec3(along * (chord.dot(along) / along.squaredNorm()))
                           : Vec3(chord - normal * normal.dot(chord));
  const double cosine = tangent.norm() / length;
  // Edges that leave their chord by a right angle or so have no reliable tangent
  if (!(cosine > 0.3)) return from + chord / 3;
  return from + tangent / cosine * (2.0 / 3) / (1 + cosine);
}

Patch patch_of(const TriangleMesh& mesh, const MeshNormals& normals, int triangle) {
  Patch patch;
  for (int i = 0; i < 3; ++i) patch.corners[i] = mesh.corners[mesh.triangles[triangle][i]];
  const auto control = [&](int from, int to, int edge) {
    const Vec3& normal = normals.at(triangle, from);
    const Vec3& beyond =
        normals.is_smooth(triangle, edge) ? normal : normals.beyond(triangle, edge, from);
    return control_point(patch.corners[from], patch.corners[to], normal, beyond);
  };
  Vec3 corners = Vec3::Zero(), controls = Vec3::Zero();
  for (int i = 0; i < 3; ++i) {
    patch.ahead[i] = control(i, (i + 1) % 3, i);
    patch.back[i] = control(i, (i + 2) % 3, (i + 2) % 3);
    corners += patch.corners[i] / 3;
    controls += (patch.ahead[i] + patch.back[i]) / 6;
  }
  patch.middle = controls + (controls - corners) / 2;
  return patch;
}

/// Whether a patch is the plane triangle of its corners, within rounding.
bool is_plane(const Patch& patch) {
  const Vec3 a = patch.corners[1] - patch.corners[0], b = patch.corners[2] - patch.corners[0];
  const Vec3 normal = a.cross(b).normalized();
  const double size = std::max(a.norm(), b.norm());
  double off = 0;
  for (int i = 0; i < 3; ++i) {
    const Vec3 chord = patch.corners[(i + 1) % 3] - patch.corners[i];
    const Vec3 ahead = patch.ahead[i] - patch.corners[i];
    off = std::max({off, std::abs(normal.dot(ahead)), ahead.cross(chord.normalized()).norm(),
                    std::abs(normal.dot(patch.back[i] - patch.corners[i]))});
  }
  return off <= 1e-9 * size;
}

/// Adds the small triangles of a patch that is divided into `parts` along each side.
void add_patch(const Patch& patch, int parts, TriangleMesh& mesh) {
  const auto first = static_cast<int>(mesh.corners.size());
  const auto number = [&](int i, int j) { return first + i * (i + 1) / 2 + j; };
  for (int i = 0; i <= parts; ++i)
    for (int j = 0; j <= i; ++j) {
      const double n = parts;
      mesh.corners.push_back(patch.at((parts - i) / n, (i - j) / n, j / n));
    }
  for (int i = 0; i < parts; ++i)
    for (int j = 0; j <= i; ++j) {
      mesh.triangles.push_back({number(i, j), number(i + 1, j), number(i + 1, j + 1)});
      if (j < i) mesh.triangles.push_back({number(i, j), number(i + 1, j + 1), number(i, j + 1)});
    }
}

int divisions_of(const Patch& patch, double longest) {
  constexpr int most = 256;
  if (is_plane(patch)) return 1;
  double side = 0;
  for (int i = 0; i < 3; ++i)
    side = std::max(side, (patch.corners[(i + 1) % 3] - patch.corners[i]).norm());
  return static_cast<int>(std::clamp(std::ceil(side / longest), 2.0, double{most}));
}

}  // namespace

CurvedMesh curved_mesh(const TriangleMesh& mesh, double crease, double longest) {
  constexpr double finest = 1.0 / 256;  // relative to the size, which limits time and memory
  const Box box = bounds(mesh);
  longest = std::max(longest, finest * (box.high - box.low).maxCoeff());
  const MeshNormals normals(mesh, crease);
  CurvedMesh curved{.mesh = {}, .given_volume = volume(mesh), .creases = normals.creases()};
  if (!(crease > 0)) {
    curved.mesh = mesh;
    return curved;
  }
  curved.largest_bend = normals.largest_bend();
  curved.mesh.turned = mesh.turned;
  for (int t = 0; t < static_cast<int>(mesh.triangles.size()); ++t) {
    const Patch patch = patch_of(mesh, normals, t);
    add_patch(patch, divisions_of(patch, longest), curved.mesh);
  }
  return curved;
}

}  // namespace flatspeckle::grin
