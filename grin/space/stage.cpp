#include "grin/space/stage.h"

#include <algorithm>
#include <cmath>
#include <sstream>

#include "core/error.h"
#include "grin/geometry/vector_values.h"

namespace flatspeckle::grin {

namespace {

Box bounds(const Sphere& s) {
  const Vec3 half = Vec3::Constant(s.radius);
  return {s.centre - half, s.centre + half};
}
Box bounds(const Box& b) {
  return b;
}
Box bounds(const DistanceGrid& g) {  // the surface is a cell or more inside its grid
  return {g.low() + Vec3::Constant(g.spacing()), g.high() - Vec3::Constant(g.spacing())};
}
Box bounds(const Plane&) {
  throw InputError("a plane is no boundary of a stage or body: it is not closed");
}

/// Of a path from the middle: diffusion, or what absorption and roulette leave of it.
double most_scatterings(const ScatteringMedium& medium, const Surface& within, double density) {
  const auto [low, high] = bounds(within);
  const double depth = medium.mu_s * density * (high - low).minCoeff() / 2;
  return std::min(1.5 * depth * depth * (1 - medium.phase.mean_cosine()),
                  4 / (1 - medium.albedo()));
}

void check_path_lengths(const ScatteringMedium& medium, const Surface& within, double density,
                        const std::string& prefix) {
  constexpr double most = 1e8;
  const double scatterings = most_scatterings(medium, within, density);
  if (scatterings <= most) return;
  std::ostringstream text;
  text << "is too dense: light from the middle would scatter some " << scatterings
       << " times, and paths of more than " << most
       << " do not end in time; max_scatterings cuts them short";
  throw InputError(prefix + "mu_s", medium.mu_s, text.str());
}

/// Flights through a density grid go from one tentative collision to the next, as many where the
/// grid is thin or ends.
void check_flights(const ScatteringMedium& medium, const Surface& within,
                   const std::string& prefix) {
  if (!medium.density) return;
  constexpr double most = 1e6;
  const auto [low, high] = bounds(within);
  const double collisions = medium.mu_t() * medium.density->largest() * (high - low).norm();
  if (collisions <= most) return;
  std::ostringstream text;
  text << "is too dense: a flight through its density grid might meet " << collisions
       << " tentative collisions, and more than " << most << " do not end in time";
  const bool scatters = medium.mu_s >= medium.mu_a;
  throw InputError(prefix + (scatters ? "mu_s" : "mu_a"), scatters ? medium.mu_s : medium.mu_a,
                   text.str());
}

ScatteringMedium without_scattering(ScatteringMedium medium) {
  medium.mu_a = medium.mu_t();
  medium.mu_s = 0;
  return medium;
}

}  // namespace

Box bounds(const Surface& surface) {
  return std::visit([](const auto& s) { return bounds(s); }, surface);
}

bool lies_in(const Surface& inner, const Surface& outer) {
  const auto [outer_low, outer_high] = bounds(outer);
  const double rounding = 1e-9 * (outer_high - outer_low).norm();
  if (const Sphere* sphere = std::get_if<Sphere>(&inner))
    return distance(outer, sphere->centre) <= rounding - sphere->radius;
  const auto [low, high] = bounds(inner);
  for (int corner = 0; corner < 8; ++corner) {
    const Vec3 x(corner & 1 ? low[0] : high[0], corner & 2 ? low[1] : high[1],
                 corner & 4 ? low[2] : high[2]);
    if (!(distance(outer, x) <= rounding)) return false;
  }
  return true;
}

Stage without_scattering(const Stage& stage) {
  Stage black = stage;
  black.medium = without_scattering(stage.medium);
  if (stage.body) black.body->medium = without_scattering(stage.body->medium);
  return black;
}

void check(const Stage& stage) {
  bounds(stage.boundary);
  check_flights(stage.medium, stage.boundary, "");
  if (!stage.body) return;
  check_flights(stage.body->medium, stage.body->surface, "body_");
  if (!lies_in(stage.body->surface, stage.boundary))
    throw InputError(
        "body: must be inside of the stage; of luneburg without one the ball, or the stage inside "
        "of it");
}

void check_path_lengths(const Stage& stage, int max_scatterings) {
  if (max_scatterings <= 100'000'000) return;
  check_path_lengths(stage.medium, stage.boundary, mean_density(stage, false), "");
  if (stage.body)
    check_path_lengths(stage.body->medium, stage.body->surface, mean_density(stage, true), "body_");
}

void require_in_stage(const Stage& stage, const Vec3& x) {
  if (!(distance(stage.boundary, x) <= 1e-9 * x.norm()))
    throw InputError("sensor_at", listed(x), "must be inside the stage");
  if (stage.body && !(distance(stage.body->surface, x) >= 0))
    throw InputError("sensor_at", listed(x), "must not be inside the body");
}

double mean_density(const Stage& stage, bool in_body) {
  constexpr int points = 32;  // along an axis
  const ScatteringMedium& medium = in_body ? stage.body->medium : stage.medium;
  if (!medium.density) return 1;
  const auto [low, high] = bounds(in_body ? stage.body->surface : stage.boundary);
  double sum = 0;
  int inside = 0;
  for (int point = 0; point < points * points * points; ++point) {
    const Vec3 at(point / points / points, point / points % points, point % points);
    const Vec3 share = (at + Vec3::Constant(0.5)) / points;
    const Vec3 x = low + share.cwiseProduct(high - low);
    const bool is_in_body = stage.body && distance(stage.body->surface, x) < 0;
    if (is_in_body != in_body || distance(stage.boundary, x) > 0) continue;
    sum += (*medium.density)(x);
    ++inside;
  }
  return inside > 0 ? sum / inside : 1;
}

}  // namespace flatspeckle::grin
