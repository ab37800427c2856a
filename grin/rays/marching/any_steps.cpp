#include "grin/rays/marching/any_steps.h"

namespace flatspeckle::grin {

void RayPath::add(const RayState& ray) {
  if (ray.x.allFinite() && ray.v.allFinite())
    nodes_.push_back({ray.arc_length, ray.x, ray.v.normalized()});
}

void RayPath::end_with(const RayState& ray) {
  while (!nodes_.empty() && nodes_.back().s >= ray.arc_length) nodes_.pop_back();
  add(ray);
}

Vec3 RayPath::between(const Node& a, const Node& b, double s) {
  const double h = b.s - a.s;
  if (!(h > 0)) return a.x;
  const double t = (s - a.s) / h, u = 1 - t;
  return u * u * (1 + 2 * t) * a.x + t * t * (1 + 2 * u) * b.x +
         h * t * u * (u * a.direction - t * b.direction);
}

std::vector<Vec3> RayPath::points(std::size_t count) const {
  std::vector<Vec3> points;
  const double first = nodes_.front().s, length = nodes_.back().s - first;
  std::size_t node = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const double s = first + length * static_cast<double>(i) / static_cast<double>(count - 1);
    while (node + 2 < nodes_.size() && nodes_[node + 1].s < s) ++node;
    points.push_back(between(nodes_[node], nodes_[std::min(node + 1, nodes_.size() - 1)], s));
  }
  return points;
}

}  // namespace flatspeckle::grin
