#include "grin/stage.h"

#include <array>
#include <cmath>

#include "core/error.h"

namespace flatspeckle::grin {

namespace {

struct Bounds {
  Vec3 low, high;
};
Bounds bounds(const Sphere& s) {
  return {s.centre - Vec3::Constant(s.radius), s.centre + Vec3::Constant(s.radius)};
}
Bounds bounds(const Box& b) {
  return {b.low, b.high};
}
Bounds bounds(const DistanceGrid& g) {  // the surface is a cell or more inside its grid
  return {g.low() + Vec3::Constant(g.spacing()), g.high() - Vec3::Constant(g.spacing())};
}
Bounds bounds(const Plane&) {
  throw InputError("a plane is no boundary of a stage or body: it is not closed");
}

void check_size(const char* key, const Surface& surface) {
  const auto [low, high] = std::visit([](const auto& s) { return bounds(s); }, surface);
  if (!low.allFinite() || !high.allFinite() || !((high - low).minCoeff() > 0))
    throw InputError(key, (high - low).transpose(), "must be a finite box or sphere of some size");
}

/// Touching is allowed.
bool lies_in(const Surface& body, const Surface& boundary) {
  const auto [low, high] = std::visit([](const auto& s) { return bounds(s); }, body);
  const double rounding = 1e-9 * (high - low).norm();
  if (const Sphere* sphere = std::get_if<Sphere>(&body))
    return distance(boundary, sphere->centre) <= rounding - sphere->radius;
  for (int corner = 0; corner < 8; ++corner) {
    const Vec3 x(corner & 1 ? low[0] : high[0], corner & 2 ? low[1] : high[1],
                 corner & 4 ? low[2] : high[2]);
    if (!(distance(boundary, x) <= rounding)) return false;
  }
  return true;
}

ScatteringMedium without_scattering(ScatteringMedium medium) {
  medium.mu_a = medium.mu_t();
  medium.mu_s = 0;
  return medium;
}

}  // namespace

Stage without_scattering(const Stage& stage) {
  Stage black = stage;
  black.medium = without_scattering(stage.medium);
  if (stage.body) black.body->medium = without_scattering(stage.body->medium);
  return black;
}

void check(const Stage& stage) {
  check_size("stage", stage.boundary);
  check(stage.medium, "");
  if (!(stage.excess_around > -1) || !std::isfinite(stage.excess_around))
    throw InputError("index_around", 1 + stage.excess_around, "must be positive and finite");
  if (!stage.body) return;
  check_size("body", stage.body->surface);
  check(stage.body->medium, "body_");
  if (!lies_in(stage.body->surface, stage.boundary))
    throw InputError("the body reaches out of the stage: it must lie within its boundary");
}

}  // namespace flatspeckle::grin
