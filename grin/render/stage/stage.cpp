#include "grin/render/stage/stage.h"

#include <algorithm>
#include <cmath>
#include <sstream>
#include <string>

#include "core/error.h"
#include "grin/media/geometry/vector_values.h"
#include "grin/rays/surfaces/straight_crossing.h"
#include "grin/render/stage/regions.h"

namespace flatspeckle::grin {

namespace {

/// Estimates the number of scatterings of a path from the middle of a region, as its optical depth
/// (light that goes straight on) plus a term for diffusion, limited by absorption and Russian
/// roulette.
double most_scatterings(const ScatteringMedium& medium, const Surface& within, double density) {
  const auto [low, high] = bounds(within);
  const double depth = medium.mu_s * density * (high - low).minCoeff() / 2;
  return std::min(depth + 1.5 * depth * depth * (1 - medium.phase.mean_cosine()),
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
       << " scatterings take too long; limit them by max_scatterings";
  throw InputError(prefix + "mu_s", medium.mu_s, text.str());
}

/// Throws InputError if flights through a density grid take too long. Tentative collisions are as
/// frequent where the density is low, or beyond the grid, as where it is largest.
void check_flights(const ScatteringMedium& medium, const Surface& within,
                   const std::string& prefix) {
  if (medium.is_uniform()) return;
  constexpr double most = 1e6;
  const auto [low, high] = bounds(within);
  const double collisions = medium.mu_t() * medium.largest_relative() * (high - low).norm();
  if (collisions <= most) return;
  std::ostringstream text;
  text << "is too dense: a flight through its grid may have " << collisions
       << " tentative collisions, and more than " << most << " take too long";
  const bool scatters = medium.mu_s >= medium.mu_a;
  throw InputError(prefix + (scatters ? "mu_s" : "mu_a"), scatters ? medium.mu_s : medium.mu_a,
                   text.str());
}

double largest_coordinate(const Box& box) {
  return box.low.cwiseAbs().cwiseMax(box.high.cwiseAbs()).maxCoeff();
}

/// Whether two closed surfaces are equal to rounding: they have the same bounds, and lines along
/// the axes cross both at the same positions.
bool coincide(const Surface& a, const Surface& b) {
  constexpr int lines = 7;
  const Box box = bounds(a), other = bounds(b);
  const double same =
      crossing_accuracy(std::max(largest_coordinate(box), largest_coordinate(other)));
  const auto far_apart = [&](const Vec3& x, const Vec3& y) {
    return !((x - y).cwiseAbs().maxCoeff() <= same);
  };
  if (far_apart(box.low, other.low) || far_apart(box.high, other.high)) return false;
  for (int line = 0; line < 3 * lines * lines; ++line) {
    const int axis = line % 3, i = line / 3 % lines, j = line / 3 / lines;
    Vec3 share = Vec3::Constant(-0.1);
    share[(axis + 1) % 3] = (i + 0.5) / lines;
    share[(axis + 2) % 3] = (j + 0.5) / lines;
    const Vec3 x = box.low + share.cwiseProduct(box.high - box.low), d = Vec3::Unit(axis);
    const double to_a = entry_distance(a, x, d), to_b = entry_distance(b, x, d);
    if (to_a != to_b && !(std::abs(to_a - to_b) <= 1e3 * same)) return false;
  }
  return true;
}

std::string name_of(const Body& body) {
  const std::string keys = body.keys, name = keys.substr(0, keys.find_first_of(",_"));
  const auto [low, high] = bounds(body.surface);
  return name + " from " + listed(low) + " to " + listed(high);
}

ScatteringMedium without_scattering(ScatteringMedium medium) {
  medium.mu_a = medium.mu_t();
  medium.mu_s = 0;
  return medium;
}

}  // namespace

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

Part Stage::field_part() const {
  for (Part part = 1; part < parts(); ++part)
    if (!bodies[part - 1].excess) return part;
  return around;
}

bool Stage::has_opaque_bodies() const {
  return std::any_of(bodies.begin(), bodies.end(),
                     [](const Body& body) { return body.is_opaque(); });
}

bool Stage::absorbs() const {
  return medium.mu_a > 0 || std::any_of(bodies.begin(), bodies.end(),
                                        [](const Body& body) { return body.medium.mu_a > 0; });
}

Stage without_scattering(const Stage& stage) {
  Stage black = stage;
  black.medium = without_scattering(stage.medium);
  for (Body& body : black.bodies) body.medium = without_scattering(body.medium);
  return black;
}

void check_bodies(const Stage& stage) {
  for (Part part = 1; part < stage.parts(); ++part) {
    const Body& body = stage.bodies[part - 1];
    const Box box = bounds(body.surface);
    if (!((box.high - box.low).minCoeff() > 8 * crossing_accuracy(largest_coordinate(box))))
      throw InputError(name_of(body) +
                       ": is too thin to be resolved at coordinates as large as its own; move it "
                       "closer to the origin");
    for (Part other = 1; other < part; ++other)
      if (coincide(body.surface, stage.bodies[other - 1].surface))
        throw InputError(name_of(body) + ": coincides with " + name_of(stage.bodies[other - 1]) +
                         "; a body may be given once only");
  }
}

void check(const Stage& stage) {
  bounds(stage.boundary);
  check_flights(stage.medium, stage.boundary, "");
  check_bodies(stage);
  for (Part part = 1; part < stage.parts(); ++part) {
    const Body& body = stage.bodies[part - 1];
    check_flights(body.medium, body.surface, body.keys);
    if (!lies_in(body.surface, stage.boundary))
      throw InputError(
          "body: must be inside of the stage; for luneburg without a body, either the ball must be "
          "inside of the stage, or the stage inside of the ball");
    if (!body.excess && part != stage.field_part())
      throw InputError("body: only one body may be filled by the index field");
  }
}

void check_path_lengths(const Stage& stage, int max_scatterings) {
  if (max_scatterings <= 100'000'000) return;
  for (Part part = around; part < stage.parts(); ++part)
    check_path_lengths(stage.medium_in(part), stage.surface(part), mean_density(stage, part),
                       part == around ? "" : stage.bodies[part - 1].keys);
}

double most_scatterings(const Stage& stage) {
  double most = 0;
  for (Part part = around; part < stage.parts(); ++part)
    most = std::max(most, most_scatterings(stage.medium_in(part), stage.surface(part),
                                           mean_density(stage, part)));
  return most;
}

}  // namespace flatspeckle::grin
