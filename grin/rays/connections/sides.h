#pragma once

#include <span>

#include "grin/rays/marching/step_curve.h"
#include "grin/rays/surfaces/first_crossing.h"
#include "grin/rays/surfaces/signed_distance.h"

namespace flatspeckle::grin {

/// The region that lies on a given side of each of several surfaces.
struct Sides {
  std::span<const Surface> surfaces;
  /// For each surface, the side on which the region lies: 1 for inside, -1 for outside.
  std::span<const double> signs;
  double tolerance = 0;  ///< points up to this distance beyond a surface count as inside the region

  bool operator()(const Vec3& x) const {
    for (std::size_t i = 0; i < surfaces.size(); ++i)
      if (!(signs[i] * distance(surfaces[i], x) <= tolerance)) return false;
    return true;
  }
  /// Whether a step, including its ends, stays in the region. h: length of the step in sigma.
  bool keep(const RayState& start, const RayState& end, double h) const {
    const StepCurve curve(start, end, h);
    const double arc = 1.1 * (end.arc_length - start.arc_length);
    for (std::size_t i = 0; i < surfaces.size(); ++i) {
      const auto depth = [&](const Vec3& x) {
        return tolerance - signs[i] * distance(surfaces[i], x);
      };
      const Bracket all{0, 1, depth(start.x), depth(end.x)};
      if (first_change([&](double theta) { return depth(curve.x(theta)); }, all, arc)) return false;
    }
    return true;
  }
};

}  // namespace flatspeckle::grin
