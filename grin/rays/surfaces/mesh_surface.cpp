#include "grin/rays/surfaces/mesh_surface.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <map>
#include <numbers>
#include <sstream>
#include <string>
#include <utility>

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
    std::ranges::rotate(corners, std::ranges::min_element(corners));
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

[[noreturn]] void refuse_open(const TriangleMesh& mesh) {
  constexpr std::size_t most = 3;
  const auto edges = passed_edges(mesh);
  std::size_t open = 0;
  std::ostringstream places;
  for (const auto& [edge, more] : edges)
    if (more != 0 && ++open <= most)
      places << (open == 1 ? "" : ", ") << "from " << listed(mesh.corners[edge.first]) << " to "
             << listed(mesh.corners[edge.second]);
  std::ostringstream text;
  text << "is not a closed surface with consistently oriented triangles: " << open << " of "
       << edges.size() << " edges are not shared by opposite triangles: " << places.str()
       << (open > most ? ", ..." : "");
  throw InputError(text.str());
}

/// Merges corners until the surface is closed: first corners that are equal within the rounding of
/// double precision, then of single precision, then within 1e-5 of the size of the body.
TriangleMesh closed(TriangleMesh mesh) {
  const Box box = bounds(mesh);
  const double size = (box.high - box.low).norm();
  cancel_triangles(mesh);
  for (const double tolerance : {1e-12, 1e-8, 1e-5}) {
    if (is_closed(mesh)) return mesh;
    mesh = welded(mesh, tolerance * size);
    cancel_triangles(mesh);
  }
  if (!is_closed(mesh)) refuse_open(mesh);
  return mesh;
}

void check_encloses(const TriangleMesh& mesh) {
  constexpr double least = 1e-9;
  const Box box = bounds(mesh);
  if (std::abs(volume(mesh)) > least * area(mesh) * (box.high - box.low).maxCoeff()) return;
  throw InputError(
      "encloses no volume: it is flat, or the triangles of its parts have opposite orientations");
}

Vec3 doubled_area(const TriangleMesh& mesh, const std::array<int, 3>& triangle) {
  const auto& [a, b, c] = triangle;
  return (mesh.corners[b] - mesh.corners[a]).cross(mesh.corners[c] - mesh.corners[a]);
}

constexpr int leaf_size = 4;

double squared_to_segment(const Vec3& x, const Vec3& a, const Vec3& b) {
  const Vec3 along = b - a;
  const double length = along.squaredNorm();
  const double t = length > 0 ? std::clamp(along.dot(x - a) / length, 0.0, 1.0) : 0;
  return (a + t * along - x).squaredNorm();
}

/// Returns the squared distance to the plane of the triangle if x lies above or below the triangle,
/// otherwise to its edges.
double squared_to_triangle(const Vec3& x, const Vec3& a, const Vec3& b, const Vec3& c) {
  const Vec3 n = (b - a).cross(c - a);
  const auto left_of = [&](const Vec3& from, const Vec3& to) {
    return (to - from).cross(x - from).dot(n) >= 0;
  };
  if (n.squaredNorm() > 0 && left_of(a, b) && left_of(b, c) && left_of(c, a)) {
    const double height = n.dot(x - a);
    return height * height / n.squaredNorm();
  }
  return std::min(
      {squared_to_segment(x, a, b), squared_to_segment(x, b, c), squared_to_segment(x, c, a)});
}

double squared_to_box(const Vec3& x, const Vec3& low, const Vec3& high) {
  return (low - x).cwiseMax(x - high).cwiseMax(0).squaredNorm();
}

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
  for (int i = 0; i < grid.nodes[0]; ++i)
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

double volume_change(const LevelSurface& surface) {
  return surface.volume() / surface.meant_volume() - 1;
}

void check_volume(const LevelSurface& surface) {
  constexpr double most = 0.05;
  const double change = volume_change(surface);
  if (std::abs(change) <= most) return;
  std::ostringstream text;
  text << "the smooth surface would enclose " << 100 * std::abs(change) << " % "
       << (change < 0 ? "less" : "more") << " than the mesh";
  throw InputError(text.str());
}

}  // namespace

TriangleMesh closed_mesh(const std::vector<Vec3>& corners) {
  check_corners(corners);
  TriangleMesh mesh = with_shared_corners(corners);
  if (mesh.triangles.empty()) throw InputError("has no triangle with an area");
  mesh = closed(std::move(mesh));
  check_encloses(mesh);
  if (volume(mesh) < 0)
    for (auto& triangle : mesh.triangles) std::swap(triangle[1], triangle[2]);
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

MeshDistance::MeshDistance(const TriangleMesh& mesh) {
  for (const auto& [a, b, c] : mesh.triangles)
    triangles_.push_back({mesh.corners[a], mesh.corners[b], mesh.corners[c]});
  build(0, static_cast<int>(triangles_.size()));
}

/// Builds a node of the tree from triangles begin to end - 1 and returns its number. Divides the
/// triangles into two halves along the longest side of their box.
int MeshDistance::build(int begin, int end) {
  constexpr double infinity = std::numeric_limits<double>::infinity();
  Vec3 low = Vec3::Constant(infinity), high = -low;
  for (int i = begin; i < end; ++i) {
    const auto& [a, b, c] = triangles_[i];
    low = low.cwiseMin(a).cwiseMin(b).cwiseMin(c);
    high = high.cwiseMax(a).cwiseMax(b).cwiseMax(c);
  }
  const int number = static_cast<int>(nodes_.size());
  nodes_.push_back({low, high, begin, end});
  add_up(nodes_.back());
  if (end - begin <= leaf_size) return number;
  int axis;
  (high - low).maxCoeff(&axis);
  const int middle = (begin + end) / 2;
  std::nth_element(triangles_.begin() + begin, triangles_.begin() + middle,
                   triangles_.begin() + end, [&](const Triangle& p, const Triangle& q) {
                     return (p.a + p.b + p.c)[axis] < (q.a + q.b + q.c)[axis];
                   });
  const int left = build(begin, middle), right = build(middle, end);
  nodes_[number].left = left;
  nodes_[number].right = right;
  return number;
}

void MeshDistance::add_up(Node& node) const {
  double size = 0;
  for (int i = node.begin; i < node.end; ++i) {
    const auto& [a, b, c] = triangles_[i];
    const Vec3 area = (b - a).cross(c - a) / 2;
    node.area += area;
    node.middle += area.norm() / 3 * (a + b + c);
    size += area.norm();
  }
  node.middle = size > 0 ? Vec3(node.middle / size) : node.low;
  node.radius = (node.middle - node.low).cwiseMax(node.high - node.middle).norm();
}

double MeshDistance::unsigned_distance(const Vec3& x, double bound) const {
  double squared = bound * bound;
  nearest(0, x, squared);
  return std::sqrt(squared);
}

void MeshDistance::nearest(int number, const Vec3& x, double& squared) const {
  const Node& node = nodes_[number];
  if (squared_to_box(x, node.low, node.high) >= squared) return;
  if (node.left < 0) {
    for (int i = node.begin; i < node.end; ++i)
      squared = std::min(squared,
                         squared_to_triangle(x, triangles_[i].a, triangles_[i].b, triangles_[i].c));
    return;
  }
  const Node &left = nodes_[node.left], &right = nodes_[node.right];
  const bool left_first =
      squared_to_box(x, left.low, left.high) <= squared_to_box(x, right.low, right.high);
  nearest(left_first ? node.left : node.right, x, squared);
  nearest(left_first ? node.right : node.left, x, squared);
}

double MeshDistance::winding_number(const Vec3& x) const {
  return solid_angle(0, x) / (4 * std::numbers::pi);
}

double MeshDistance::solid_angle(int number, const Vec3& x) const {
  // Distance, in radii of a tree node, beyond which the node counts as one facet
  constexpr double far = 3;
  const Node& node = nodes_[number];
  const Vec3 to_middle = node.middle - x;
  if (const double distance = to_middle.norm(); distance > far * node.radius)
    return node.area.dot(to_middle) / (distance * distance * distance);
  if (node.left >= 0) return solid_angle(node.left, x) + solid_angle(node.right, x);
  double sum = 0;
  for (int i = node.begin; i < node.end; ++i) {
    const Vec3 a = triangles_[i].a - x, b = triangles_[i].b - x, c = triangles_[i].c - x;
    const double p = a.norm(), q = b.norm(), r = c.norm();
    sum +=
        2 * std::atan2(a.dot(b.cross(c)), p * q * r + a.dot(b) * r + b.dot(c) * p + c.dot(a) * q);
  }
  return sum;
}

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

LevelSurface mesh_surface(const TriangleMesh& mesh, const std::string& key) {
  constexpr double few_cells = 64, most_cells = 256, right = 0.01;
  const Box box = bounds(mesh);
  const double longest = (box.high - box.low).maxCoeff();
  for (double cells = few_cells; cells < most_cells; cells *= 2) {
    try {
      const LevelSurface surface = mesh_surface(mesh, longest / cells, key);
      if (std::abs(volume_change(surface)) < right) return surface;
    } catch (const OverlapError&) {
      throw;
    } catch (const InputError&) {  // this spacing is too coarse
    }
  }
  return mesh_surface(mesh, longest / most_cells, key);
}

}  // namespace flatspeckle::grin
