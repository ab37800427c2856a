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

/// Bodies that rays pass, as keys have them: those of render's stage.
struct RayBodyValues : FieldBodyValues {
  PlainBodyValues plain_bodies{};
};

void add_keys(Keys& keys, RayBodyValues& values);

/// A stage around them, whose boundary rays need not know of. A field that fills a body loses its
/// rim, box and symmetry, as rays see that body. Throws InputError.
Stage make_ray_stage(const Keys& keys, const RayBodyValues& values, SceneField& field);

/// 0 where there is no field.
double index_at(const SceneField& field, const Stage& stage, const Vec3& x);

/// How a ray ended, by its number in the file.
enum class RayStatus : std::uint64_t { surface, length, edge_of_grid };

struct TracedRay {
  RayStatus status = RayStatus::length;
  std::uint64_t surface = 0;  ///< number of it; that of all surfaces where it ended on none
  std::uint64_t steps = 0;
  RayState end = {};
  double index_mismatch = 0;  ///< largest ||v| - n| on the way (RayLog)
  double transmittance = 1;   ///< what the surfaces and media of bodies leave of unpolarised light
  double end_slope = 0;       ///< |grad n| at the end
  RayInvariants first = {}, last = {};
  std::vector<Vec3> path = {};
};

/// At the bodies of the stage rays are refracted (Snell), or reflected where that is total.
/// path_points: so many of each ray, evenly over its arc length, first and last included; or none.
/// Throws InputError for a ray that starts behind a plane or outside of the field, or comes to
/// where the index is not positive.
std::vector<TracedRay> trace_rays(const SceneField& scene, const Stage& stage,
                                  const RayStops& stops, const RaySteps& steps,
                                  const std::vector<RayStart>& starts, std::size_t path_points);

}  // namespace flatspeckle::grin
