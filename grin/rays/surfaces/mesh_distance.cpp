#include "grin/rays/surfaces/mesh_distance.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include <Eigen/Geometry>

namespace flatspeckle::grin {

namespace {

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

}  // namespace

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

}  // namespace flatspeckle::grin
