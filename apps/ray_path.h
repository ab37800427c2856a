#pragma once

#include <vector>

#include "grin/rays/ray.h"

namespace flatspeckle::apps {

/// What a ray passes, so that it can be drawn: points evenly spaced in arc length, by cubics
/// between steps.
class RayPath {
 public:
  void add(const grin::RayState& ray);
  /// The ray goes no farther than here; what was added beyond does not count.
  void end_with(const grin::RayState& ray);

  /// From first to last; count >= 2.
  std::vector<grin::Vec3> points(std::size_t count) const;

 private:
  struct Node {
    double s;
    grin::Vec3 x, direction;
  };
  static grin::Vec3 between(const Node& a, const Node& b, double s);

  std::vector<Node> nodes_;
};

}  // namespace flatspeckle::apps
