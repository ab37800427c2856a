#pragma once

#include <cstdint>
#include <vector>

#include "grin/media/fields/scene_field.h"
#include "grin/rays/marching/ray_invariants.h"
#include "grin/rays/marching/ray_starts.h"
#include "grin/rays/marching/ray_stops.h"
#include "grin/render/stage/stage.h"
#include "grin/render/values/field_body.h"

namespace flatspeckle::grin {

/// Scene keys of the bodies that rays pass through; `render` uses the same keys.
struct RayBodyValues : FieldBodyValues {
  PlainBodyValues plain_bodies{};
  std::vector<double> aperture{};
};

void add_keys(Keys& keys, RayBodyValues& values);

/// Makes the geometry (Stage) with the bodies given by these keys. The outer boundary of the stage
/// does not affect rays. If the index field fills a body, the rim, grid box and symmetry of the
/// field are removed, because the surface of the body replaces them. length_unit: metres in a unit
/// of length, for glasses. Throws InputError.
Stage make_ray_stage(const Keys& keys, const RayBodyValues& values, SceneField& field,
                     const std::optional<double>& length_unit);

/// An opaque screen with a round hole.
struct RayAperture {
  Plane plane;
  double radius;
};
std::vector<RayAperture> make_apertures(const Keys& keys, const RayBodyValues& values);

/// Refractive index at x; 0 outside the field.
double index_at(const SceneField& field, const Stage& stage, const Vec3& x);

/// Reason why a ray ended; the dataset `status` contains these values.
enum class RayStatus : std::uint64_t { surface, length, edge_of_grid, absorbed };

struct TracedRay {
  RayStatus status = RayStatus::length;
  /// Number of the stop surface on which the ray ended; the number of all stop surfaces if on none.
  std::uint64_t surface = 0;
  std::uint64_t steps = 0;
  RayState end = {};
  double index_mismatch = 0;  ///< largest difference between |v| and n along the ray
  /// Fraction of unpolarised light that the surfaces and media of the bodies transmit along the
  /// ray.
  double transmittance = 1;
  double end_derivative = 0;  ///< |grad n| at the end of the ray
  RayInvariants first = {}, last = {};
  std::vector<Vec3> path = {};
};

/// Traces rays. The surfaces of the stage's bodies refract (Snell), reflect or absorb them, and
/// apertures absorb those that miss their holes.
/// path_points is the number of points stored per ray, equidistant in arc length and including both
/// ends; 0 stores no points. Throws InputError for a ray that starts behind a stop plane or outside
/// the field, or that reaches a place where the index is not positive.
std::vector<TracedRay> trace_rays(const SceneField& scene, const Stage& stage,
                                  const RayStops& stops, const RaySteps& steps,
                                  const std::vector<RayStart>& starts, std::size_t path_points,
                                  const std::vector<RayAperture>& apertures = {});

}  // namespace flatspeckle::grin
