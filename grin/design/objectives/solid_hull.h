#pragma once

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <utility>

#include "core/error.h"
#include "grin/design/forms/field_form.h"
#include "grin/rays/surfaces/signed_distance.h"

namespace flatspeckle::grin::design {

/// Returns where a straight ray enters and leaves a ball or a box, as distances along a unit
/// direction; nullopt if the ray misses the body.
inline std::optional<std::pair<double, double>> entry_and_exit(const Sphere& ball, const Vec3& x,
                                                               const Vec3& along) {
  const Vec3 r = x - ball.centre;
  const double b = r.dot(along), square = b * b - r.squaredNorm() + ball.radius * ball.radius;
  if (!(square > 0)) return std::nullopt;
  return std::pair(-b - std::sqrt(square), -b + std::sqrt(square));
}
inline std::optional<std::pair<double, double>> entry_and_exit(const Box& box, const Vec3& x,
                                                               const Vec3& along) {
  double in = -HUGE_VAL, out = HUGE_VAL;
  for (int a = 0; a < 3; ++a) {
    const auto [near, far] =
        std::minmax({(box.low[a] - x[a]) / along[a], (box.high[a] - x[a]) / along[a]});
    if (along[a] == 0) {
      if (x[a] < box.low[a] || x[a] > box.high[a]) return std::nullopt;
      continue;
    }
    in = std::max(in, near);
    out = std::min(out, far);
  }
  if (!(in < out)) return std::nullopt;
  return std::pair(in, out);
}
inline std::optional<std::pair<double, double>> entry_and_exit(const Surface& hull, const Vec3& x,
                                                               const Vec3& along) {
  if (const auto* ball = std::get_if<Sphere>(&hull)) return entry_and_exit(*ball, x, along);
  if (const auto* box = std::get_if<Box>(&hull)) return entry_and_exit(*box, x, along);
  return std::nullopt;
}

/// Surface of a ball or box that contains a field. Light enters and leaves the field there.
struct SolidHull {
  Surface surface;
  Vec3 centre;
  double radius;  ///< radius of the ball, or half a side of the box
};

/// Returns the surface that contains a field. Throws InputError for a guide, which is infinitely
/// long.
inline SolidHull solid_hull(const FieldForm& form, const std::string& goal) {
  const auto hull = hull_of(form);
  if (!hull) throw InputError("goal", goal, "requires design = box, ball or radial");
  if (const auto* ball = std::get_if<Sphere>(&*hull)) return {*hull, ball->centre, ball->radius};
  const auto& box = std::get<Box>(*hull);
  return {*hull, (box.low + box.high) / 2, (box.high - box.low)[0] / 2};
}

}  // namespace flatspeckle::grin::design
