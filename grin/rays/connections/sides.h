#pragma once

#include <span>

#include "grin/rays/marching/step_curve.h"
#include "grin/rays/surfaces/first_crossing.h"
#include "grin/rays/surfaces/signed_distance.h"

namespace flatspeckle::grin {

/// The region on one side of each surface.
struct Sides {
  std::span<const Surface> surfaces;
  std::span<const double> signs;  ///< 1: inside, -1: outside
  double tolerance = 0;           ///< so far beyond a surface is still on its side

  bool operator()(const Vec3& x) const {
    for (std::size_t i = 0; i < surfaces.size(); ++i)
      if (!(signs[i] * distance(surfaces[i], x) <= tolerance)) return false;
    return true;
  }
  /// A step h, its ends and what is between them.
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
