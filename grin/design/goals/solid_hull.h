#pragma once

#include <string>

#include "core/error.h"
#include "grin/design/forms/field_form.h"

namespace flatspeckle::grin::design {

/// Where light comes to a field and leaves it.
struct SolidHull {
  Surface surface;
  Vec3 centre;
  double radius;  ///< of a box half a side
};

/// Throws InputError for a field that has none.
inline SolidHull solid_hull(const FieldForm& form, const std::string& goal) {
  const auto hull = hull_of(form);
  if (!hull) throw InputError("goal", goal, "needs design = box, ball or radial");
  if (const auto* ball = std::get_if<Sphere>(&*hull)) return {*hull, ball->centre, ball->radius};
  const auto& box = std::get<Box>(*hull);
  return {*hull, (box.low + box.high) / 2, (box.high - box.low)[0] / 2};
}

}  // namespace flatspeckle::grin::design
