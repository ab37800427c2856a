#pragma once

#include <vector>

#include "grin/rays/marching/ray.h"

namespace flatspeckle::grin {

/// What a ray passes, so that it can be drawn: points evenly spaced in arc length, by cubics
/// between steps.
class RayPath {
 public:
  void add(const RayState& ray);
  /// The ray goes no farther than here; what was added beyond does not count.
  void end_with(const RayState& ray);

  /// From first to last; count >= 2.
  std::vector<Vec3> points(std::size_t count) const;

 private:
  struct Node {
    double s;
    Vec3 x, direction;
  };
  static Vec3 between(const Node& a, const Node& b, double s);

  std::vector<Node> nodes_;
};

}  // namespace flatspeckle::grin
