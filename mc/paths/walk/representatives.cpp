#include "mc/paths/walk/representatives.h"

#include <algorithm>
#include <cmath>

namespace flatspeckle::mc {

namespace {

/// Along w through an entry: close behind it and some mean free paths on.
bool ray_reached(const Scene& scene, Vec2 w, Vec2 entry, const std::vector<Vec2>& others) {
  const double mfp = scene.medium.mean_free_path(), chord = scene.domain.distance_to_edge(entry, w);
  constexpr double tolerated = 1.5;  // mean free paths
  for (const double deep : {0.01, 1.0, 3.0, 10.0}) {
    const double s = std::min(deep * mfp, 0.99 * chord);
    const Vec2 x = entry + s * w;
    const bool lit = std::any_of(others.begin(), others.end(), [&](Vec2 other) {
      return scene.domain.distance_to_edge(x, -other) <= s + tolerated * mfp;
    });
    if (!lit) return false;
  }
  return true;
}

}  // namespace

bool reached(const Scene& scene, Vec2 w, const std::vector<Vec2>& others, double spacing) {
  const auto& domain = scene.domain;
  const double cosine = std::cos(std::min(spacing, 3.0)) - 1e-12;
  std::vector<Vec2> close;
  for (Vec2 other : others)
    if (dot(w, other) >= cosine) close.push_back(other);
  if (close.empty()) return false;
  const double face = w.z > 0 ? 0 : domain.depth;
  if (domain.kind == Domain::Kind::slab) return ray_reached(scene, w, {0, face}, close);
  constexpr int points = 16;
  const double side = w.x > 0 ? -domain.width / 2 : domain.width / 2;
  for (int i = 0; i < points; ++i) {
    const double share = (i + 0.5) / points;
    if (w.z != 0 && !ray_reached(scene, w, {(share - 0.5) * domain.width, face}, close))
      return false;
    if (w.x != 0 && !ray_reached(scene, w, {side, share * domain.depth}, close)) return false;
  }
  return true;
}

}  // namespace flatspeckle::mc
