#pragma once

#include <cmath>
#include <sstream>

#include "core/error.h"
#include "grin/fields/vec3.h"

namespace flatspeckle::grin {

/// As the scene file has it.
inline std::string listed(const Vec3& x) {
  std::ostringstream text;
  text << x[0] << ' ' << x[1] << ' ' << x[2];
  return text.str();
}

inline std::string listed(double first, double second) {
  std::ostringstream text;
  text << first << ' ' << second;
  return text.str();
}

/// Checks of scene keys; all throw InputError.

inline void require_finite(const char* key, const Vec3& x) {
  if (!x.allFinite()) throw InputError(key, listed(x), "must be finite");
}
inline void require_positive(const char* key, double value) {
  if (!(value > 0 && std::isfinite(value)))
    throw InputError(key, value, "must be positive and finite");
}
inline Vec3 unit_direction(const char* key, const Vec3& direction) {
  require_finite(key, direction);
  const Vec3 unit = direction.stableNormalized();
  if (!(std::abs(unit.norm() - 1) < 1e-9))
    throw InputError(key, listed(direction), "must not be 0");
  return unit;
}
}  // namespace flatspeckle::grin
