#include "grin/rays/surfaces/triangle_mesh.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <map>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include <Eigen/Geometry>

#include "core/error.h"
#include "grin/media/geometry/vector_values.h"

namespace flatspeckle::grin {

namespace {

void check_corners(const std::vector<Vec3>& corners) {
  constexpr double farthest = 1e50;
  for (std::size_t i = 0; i < corners.size(); ++i)
    if (!(corners[i].array().abs() <= farthest).all())
      throw InputError(
          "corner " + std::to_string(i % 3 + 1) + " of triangle " + std::to_string(i / 3 + 1),
          listed(corners[i]), "must be finite and within 1e50");
}

TriangleMesh with_shared_corners(const std::vector<Vec3>& corners) {
  TriangleMesh mesh;
  std::map<std::array<double, 3>, int> numbers;
  const auto number = [&](const Vec3& x) {
    const auto [place, is_new] = numbers.try_emplace({x[0], x[1], x[2]}, mesh.corners.size());
    if (is_new) mesh.corners.push_back(x);
    return place->second;
  };
  for (std::size_t i = 0; i + 2 < corners.size(); i += 3) {
    const int a = number(corners[i]), b = number(corners[i + 1]), c = number(corners[i + 2]);
    if (a != b && b != c && c != a) mesh.triangles.push_back({a, b, c});
  }
  return mesh;
}

/// Merges each corner with an earlier one within `tolerance`. The cells of the hash grid are two
/// tolerances wide, so that all close corners lie in eight cells.
TriangleMesh welded(const TriangleMesh& mesh, double tolerance) {
  using Cell = std::array<std::int64_t, 3>;
  const Vec3 low = bounds(mesh).low;
  std::map<Cell, std::vector<int>> cells;
  TriangleMesh found;
  const auto cell_at = [&](const Vec3& x, double shift) {
    const Vec3 at = ((x - low) / (2 * tolerance)).array() + shift;
    return Cell{std::llround(std::floor(at[0])), std::llround(std::floor(at[1])),
                std::llround(std::floor(at[2]))};
  };
  const auto number = [&](const Vec3& x) {
    const Cell first = cell_at(x, -0.5);
    for (int i = 0; i < 8; ++i) {
      const auto cell =
          cells.find({first[0] + (i & 1), first[1] + (i >> 1 & 1), first[2] + (i >> 2)});
      if (cell == cells.end()) continue;
      for (const int other : cell->second)
        if ((found.corners[other] - x).norm() <= tolerance) return other;
    }
    found.corners.push_back(x);
    const int own = static_cast<int>(found.corners.size()) - 1;
    cells[cell_at(x, 0)].push_back(own);
    return own;
  };
  std::vector<int> numbers;
  for (const Vec3& corner : mesh.corners) numbers.push_back(number(corner));
  for (const auto& [a, b, c] : mesh.triangles)
    if (numbers[a] != numbers[b] && numbers[b] != numbers[c] && numbers[c] != numbers[a])
      found.triangles.push_back({numbers[a], numbers[b], numbers[c]});
  return found;
}

/// Removes duplicate triangles and pairs of triangles that lie back to back.
void cancel_triangles(TriangleMesh& mesh) {
  const auto key = [](std::array<int, 3> corners) {
    std::rotate(corners.begin(), std::min_element(corners.begin(), corners.end()), corners.end());
    const bool turned = corners[1] > corners[2];
    if (turned) std::swap(corners[1], corners[2]);
    return std::pair(corners, turned ? -1 : 1);
  };
  std::map<std::array<int, 3>, int> orientation_excess;
  for (const auto& triangle : mesh.triangles) {
    const auto [corners, orientation] = key(triangle);
    orientation_excess[corners] += orientation;
  }
  std::erase_if(mesh.triangles, [&](const std::array<int, 3>& triangle) {
    const auto [corners, orientation] = key(triangle);
    int& more = orientation_excess[corners];
    const bool stays = more * orientation > 0;
    if (stays) more = 0;
    return !stays;
  });
}

/// Returns for each edge how many more triangles contain it in the direction from its first to its
/// second corner than in the opposite direction.
std::map<std::pair<int, int>, int> passed_edges(const TriangleMesh& mesh) {
  std::map<std::pair<int, int>, int> orientation_excess;
  for (const auto& triangle : mesh.triangles)
    for (int i = 0; i < 3; ++i) {
      const int from = triangle[i], to = triangle[(i + 1) % 3];
      orientation_excess[std::minmax(from, to)] += from < to ? 1 : -1;
    }
  return orientation_excess;
}
bool is_closed(const TriangleMesh& mesh) {
  return std::ranges::all_of(passed_edges(mesh), [](const auto& edge) { return edge.second == 0; });
}

/// Open edges of a mesh that are connected to each other.
struct Hole {
  Vec3 middle = Vec3::Zero();
  Box extent;
  std::size_t edges = 0;
};

/// Returns the holes of a mesh: its edges that are not passed equally often in both directions,
/// grouped by common corners.
std::vector<Hole> holes(const TriangleMesh& mesh) {
  std::vector<std::pair<int, int>> open;
  for (const auto& [edge, more] : passed_edges(mesh))
    if (more != 0) open.push_back(edge);
  std::map<int, int> parent;
  const auto root = [&](int corner) {
    while (parent.try_emplace(corner, corner).first->second != corner) corner = parent[corner];
    return corner;
  };
  for (const auto& [a, b] : open) {
    const int from = root(a), to = root(b);
    parent[from] = to;
  }
  std::map<int, Hole> found;
  for (const auto& [a, b] : open) {
    const Vec3 &x = mesh.corners[a], &y = mesh.corners[b];
    Hole& hole = found.try_emplace(root(a), Hole{Vec3::Zero(), {x, x}}).first->second;
    hole.middle += (x + y) / 2;
    hole.extent = {hole.extent.low.cwiseMin(x).cwiseMin(y),
                   hole.extent.high.cwiseMax(x).cwiseMax(y)};
    ++hole.edges;
  }
  std::vector<Hole> list;
  for (auto& [corner, hole] : found) {
    hole.middle /= static_cast<double>(hole.edges);
    list.push_back(hole);
  }
  std::ranges::stable_sort(list, std::greater(), &Hole::edges);
  return list;
}

[[noreturn]] void refuse_open(const TriangleMesh& mesh, double weld) {
  constexpr std::size_t most = 3;
  const std::vector<Hole> found = holes(mesh);
  std::ostringstream text;
  text << "is not a closed surface: it has " << found.size()
       << (found.size() == 1 ? " hole" : " holes");
  for (std::size_t i = 0; i < std::min(most, found.size()); ++i) {
    const Hole& hole = found[i];
    text << (i == 0 ? ": near " : ", near ") << listed(hole.middle) << " (" << hole.edges
         << " open edges, " << (hole.extent.high - hole.extent.low).norm() << " across)";
  }
  text << (found.size() > most ? ", ..." : "") << "; corners up to " << weld << " apart are merged";
  throw InputError(text.str());
}

using Edge = std::pair<int, int>;

/// Parts of a mesh that are connected by edges of exactly two triangles. part: number of the part
/// of each triangle; turned: whether a triangle contradicts most triangles of its part.
struct MeshParts {
  std::vector<int> part;
  std::vector<char> turned;
  int count = 0;
};

MeshParts connected_parts(const TriangleMesh& mesh) {
  std::map<Edge, std::vector<int>> sides;
  const auto count = static_cast<int>(mesh.triangles.size());
  const auto edge_of = [&](int triangle, int i) {
    return Edge(mesh.triangles[triangle][i], mesh.triangles[triangle][(i + 1) % 3]);
  };
  for (int t = 0; t < count; ++t)
    for (int i = 0; i < 3; ++i)
      sides[std::minmax(edge_of(t, i).first, edge_of(t, i).second)].push_back(t);
  MeshParts parts{std::vector<int>(count, -1), std::vector<char>(count, 0)};
  for (int seed = 0; seed < count; ++seed) {
    if (parts.part[seed] >= 0) continue;
    std::vector<int> members{seed};
    parts.part[seed] = parts.count;
    for (std::size_t next = 0; next < members.size(); ++next)
      for (int i = 0; i < 3; ++i) {
        const int t = members[next];
        const Edge edge = edge_of(t, i);
        const auto& both = sides[std::minmax(edge.first, edge.second)];
        const int other = both.size() == 2 ? both[both[0] == t ? 1 : 0] : t;
        if (parts.part[other] >= 0) continue;
        bool same = false;  // whether the neighbour passes the edge in the same direction
        for (int j = 0; j < 3; ++j) same |= edge_of(other, j) == edge;
        parts.turned[other] = static_cast<char>((parts.turned[t] != 0) != same);
        parts.part[other] = parts.count;
        members.push_back(other);
      }
    const auto minority =
        std::ranges::count_if(members, [&](int t) { return parts.turned[t] != 0; });
    if (2 * minority > std::ssize(members))
      for (const int t : members) parts.turned[t] = static_cast<char>(parts.turned[t] == 0);
    ++parts.count;
  }
  return parts;
}

void turn(TriangleMesh& mesh, std::size_t triangle) {
  std::swap(mesh.triangles[triangle][1], mesh.triangles[triangle][2]);
}

/// Whether a line from x towards `d` crosses the triangle (Moeller and Trumbore).
bool crosses(const Vec3& x, const Vec3& d, const Vec3& a, const Vec3& b, const Vec3& c) {
  const Vec3 across = d.cross(c - a), from_a = x - a;
  const double determinant = across.dot(b - a);
  if (determinant == 0) return false;
  const double u = from_a.dot(across) / determinant;
  const Vec3 turned = from_a.cross(b - a);
  const double v = d.dot(turned) / determinant;
  return u >= 0 && v >= 0 && u + v <= 1 && (c - a).dot(turned) / determinant > 0;
}

/// Reverses parts that enclose a negative volume and do not lie inside another part, where they
/// would be cavities.
void turn_outside(TriangleMesh& mesh, const MeshParts& parts) {
  constexpr int most_parts = 1000;
  if (parts.count < 2 || parts.count > most_parts) return;
  std::vector<double> volumes(parts.count, 0);
  std::vector<int> first(parts.count, -1);
  const Vec3 origin = mesh.corners[mesh.triangles[0][0]];
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const int part = parts.part[t];
    volumes[part] +=
        doubled_area(mesh, mesh.triangles[t]).dot(mesh.corners[mesh.triangles[t][0]] - origin);
    if (first[part] < 0) first[part] = static_cast<int>(t);
  }
  const Vec3 towards = Vec3(0.36, 0.48, 0.8) + Vec3(1e-3, -2e-3, 3e-3);
  std::vector<char> reversed(parts.count, 0);
  for (int part = 0; part < parts.count; ++part) {
    if (volumes[part] >= 0) continue;
    const Vec3& x = mesh.corners[mesh.triangles[first[part]][0]];
    std::size_t crossings = 0;
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
      const auto& [a, b, c] = mesh.triangles[t];
      crossings += parts.part[t] != part &&
                   crosses(x, towards, mesh.corners[a], mesh.corners[b], mesh.corners[c]);
    }
    reversed[part] = static_cast<char>(crossings % 2 == 0);
  }
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
    if (reversed[parts.part[t]]) {
      turn(mesh, t);
      ++mesh.turned;
    }
}

/// Reverses triangles so that each part is oriented consistently.
TriangleMesh with_even_orientation(TriangleMesh mesh) {
  const MeshParts parts = connected_parts(mesh);
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
    if (parts.turned[t]) {
      turn(mesh, t);
      ++mesh.turned;
    }
  return mesh;
}

/// Merges corners until the surface is closed: first corners that are equal within the rounding of
/// double precision, then of single precision, then within `weld`. Reverses triangles if that
/// closes the surface.
TriangleMesh closed(TriangleMesh mesh, std::optional<double> weld) {
  const Box box = bounds(mesh);
  const double size = (box.high - box.low).norm(), widest = weld.value_or(1e-5 * size);
  for (const double tolerance : {0.0, 1e-12 * size, 1e-8 * size, widest}) {
    if (tolerance > widest) continue;
    if (tolerance > 0) mesh = welded(mesh, tolerance);
    cancel_triangles(mesh);
    if (mesh.triangles.empty() || is_closed(mesh)) return mesh;
    if (TriangleMesh even = with_even_orientation(mesh); is_closed(even)) return even;
  }
  refuse_open(mesh, widest);
}

void check_encloses(const TriangleMesh& mesh) {
  constexpr double least = 1e-9;
  const Box box = bounds(mesh);
  if (std::abs(volume(mesh)) > least * area(mesh) * (box.high - box.low).maxCoeff()) return;
  throw InputError(
      "encloses no volume: it is flat, or the triangles of its parts have opposite orientations");
}

}  // namespace

TriangleMesh closed_mesh(const std::vector<Vec3>& corners, std::optional<double> weld) {
  check_corners(corners);
  TriangleMesh mesh = with_shared_corners(corners);
  if (mesh.triangles.empty()) throw InputError("has no triangle with an area");
  mesh = closed(std::move(mesh), weld);
  if (mesh.triangles.empty())
    throw InputError("encloses no volume: all triangles lie back to back");
  check_encloses(mesh);
  if (volume(mesh) < 0)
    for (auto& triangle : mesh.triangles) std::swap(triangle[1], triangle[2]);
  turn_outside(mesh, connected_parts(mesh));
  return mesh;
}

Box bounds(const TriangleMesh& mesh) {
  Box box{mesh.corners.front(), mesh.corners.front()};
  for (const Vec3& corner : mesh.corners)
    box = {box.low.cwiseMin(corner), box.high.cwiseMax(corner)};
  return box;
}

double volume(const TriangleMesh& mesh) {
  const Vec3 from = mesh.corners.front();
  double six_times = 0;
  for (const auto& triangle : mesh.triangles)
    six_times += doubled_area(mesh, triangle).dot(mesh.corners[triangle[0]] - from);
  return six_times / 6;
}

double area(const TriangleMesh& mesh) {
  double doubled = 0;
  for (const auto& triangle : mesh.triangles) doubled += doubled_area(mesh, triangle).norm();
  return doubled / 2;
}

Vec3 doubled_area(const TriangleMesh& mesh, const std::array<int, 3>& triangle) {
  const auto& [a, b, c] = triangle;
  return (mesh.corners[b] - mesh.corners[a]).cross(mesh.corners[c] - mesh.corners[a]);
}

}  // namespace flatspeckle::grin
