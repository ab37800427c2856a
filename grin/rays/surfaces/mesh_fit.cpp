#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <limits>
#include <numbers>
#include <optional>
#include <string>

#include <Eigen/Geometry>

#include "core/numbers/random.h"
#include "grin/media/geometry/frame.h"
#include "grin/rays/surfaces/mesh_distance.h"
#include "grin/rays/surfaces/mesh_surface.h"

namespace flatspeckle::grin {

namespace {

constexpr double good_normals = 0.01, good_area = 0.05, good_volume = 0.01;
constexpr double few_cells = 64, most_cells = 256;
/// Distance from sharp edges, in spacings, up to which normals of plane faces deviate: beside edges
/// of right angles.
constexpr double edge_reach = 3;

bool follows_shape(const MeshFit& fit) {
  return fit.normal_deviation <= good_normals && std::abs(fit.area_change) <= good_area;
}
bool is_good(const MeshFit& fit) {
  return follows_shape(fit) && std::abs(fit.volume_change) <= good_volume;
}

/// Returns the distances to the sharp edges of a mesh, as triangles without area.
MeshDistance distances_to_creases(const CurvedMesh& mesh) {
  TriangleMesh edges;
  for (const auto& [a, b] : mesh.creases) {
    const auto first = static_cast<int>(edges.corners.size());
    edges.corners.insert(edges.corners.end(), {a, b});
    edges.triangles.push_back({first, first + 1, first + 1});
  }
  return MeshDistance(edges);
}

/// Returns by which factor a small triangle about x, perpendicular to `normal`, is larger after it
/// has been projected onto the surface.
double area_ratio(const LevelSurface& surface, const Vec3& x, const Vec3& normal) {
  const Frame frame = frame_across(normal);
  const double size = surface.spacing() / 8;
  const Vec3 a = x - size * (frame.col(0) + frame.col(1)), b = x + size * frame.col(0),
             c = x + size * frame.col(1);
  const Vec3 p = surface.projected(a), q = surface.projected(b), r = surface.projected(c);
  return (q - p).cross(r - p).norm() / (b - a).cross(c - a).norm();
}

/// Calls use(x, normal) for points that are spread evenly over the mesh.
template <class Use>
void sample(const TriangleMesh& mesh, const Use& use) {
  constexpr double points = 10000;
  const double all = area(mesh);
  RandomStream random(1, static_cast<std::uint64_t>(Stream::light_paths), 0);
  for (const auto& triangle : mesh.triangles) {
    const Vec3 normal = doubled_area(mesh, triangle);
    const double own = normal.norm() / 2, mean = points * own / all;
    const auto count = static_cast<int>(mean + random.uniform());
    for (int i = 0; i < count; ++i) {
      const double root = std::sqrt(random.uniform()), v = random.uniform();
      const auto& [a, b, c] = triangle;
      use(Vec3((1 - root) * mesh.corners[a] +
               root * ((1 - v) * mesh.corners[b] + v * mesh.corners[c])),
          Vec3(normal.normalized()));
    }
  }
}

}  // namespace

MeshFit fit_of(const LevelSurface& surface, const CurvedMesh& mesh) {
  const double reach = surface.spacing();
  const auto creases =
      mesh.creases.empty() ? std::nullopt : std::optional(distances_to_creases(mesh));
  double all = 0, enlarged = 0, sharp = 0, square = 0;
  sample(mesh.mesh, [&](const Vec3& x, const Vec3& normal) {
    all += 1;
    enlarged += area_ratio(surface, x, normal);
    const double far = edge_reach * reach,
                 apart = creases ? creases->unsigned_distance(x, far) : far;
    sharp += apart < far;
    if (apart < 2 * reach) return;
    const Vec3 found = surface.normal(surface.projected(x));
    const double angle = std::atan2(found.cross(normal).norm(), found.dot(normal));
    square += angle * angle;
  });
  return {surface.volume() / surface.meant_volume() - 1, enlarged / all - 1,
          std::sqrt(square / all), sharp / all};
}

double first_spacing(const TriangleMesh& mesh) {
  const Box box = bounds(mesh);
  return (box.high - box.low).maxCoeff() / few_cells;
}

LevelSurface mesh_surface(const CurvedMesh& mesh, const std::string& key) {
  const double first = first_spacing(mesh.mesh);
  for (double spacing = first; spacing > 1.5 * first * few_cells / most_cells; spacing /= 2) {
    try {
      const LevelSurface surface = mesh_surface(mesh.mesh, spacing, key);
      if (is_good(fit_of(surface, mesh))) return surface;
    } catch (const OverlapError&) {
      throw;
    } catch (const InputError&) {  // this spacing is too coarse
    }
  }
  return mesh_surface(mesh.mesh, first * few_cells / most_cells, key);
}

std::string note_on(const std::string& key, const LevelSurface& surface, const CurvedMesh& mesh) {
  constexpr double degree = std::numbers::pi / 180;
  const MeshFit fit = fit_of(surface, mesh);
  std::array<char, 640> text{};
  std::snprintf(
      text.data(), text.size(),
      "%s is replaced by a smooth surface of spacing %.3g: volume %+.2g %%, area %+.2g %%, "
      "normals %.2g degrees (rms) off",
      key.c_str(), surface.spacing(), 100 * fit.volume_change, 100 * fit.area_change,
      fit.normal_deviation / degree);
  std::string note = text.data();
  if (fit.sharp_share > 0) {
    std::snprintf(text.data(), text.size(),
                  ", edges rounded (%.2g %% of the area is within three spacings of an edge, where "
                  "normals deviate)",
                  100 * fit.sharp_share);
    note += text.data();
  }
  if (mesh.largest_bend > 1e-6) {
    std::snprintf(text.data(), text.size(),
                  "; triangles that meet at up to %.3g degrees are taken as one curved surface",
                  mesh.largest_bend / degree);
    note += text.data();
  }
  if (mesh.mesh.turned > 0)
    note += "; the orientation of " + std::to_string(mesh.mesh.turned) + " triangles was reversed";
  if (!follows_shape(fit))
    note +=
        "; warning: light is refracted as by this surface, not as by the mesh; use a finer mesh "
        "or spacing";
  return note;
}

}  // namespace flatspeckle::grin
