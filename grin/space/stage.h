#pragma once

#include <optional>

#include "grin/media/scattering_medium.h"
#include "grin/surfaces/signed_distance.h"

namespace flatspeckle::grin {

/// A thing in the stage, with its own index and medium. At its surface light is refracted and
/// reflected by Fresnel's laws where the index jumps.
struct Body {
  Surface surface;
  ScatteringMedium medium = {};
};

/// Where light goes. Light that reaches the boundary leaves the scene: nothing is reflected there.
/// With a body the index field is the body's, and around it the index is 1 + excess_around
/// everywhere; without one the field fills the stage.
struct Stage {
  Surface boundary;              ///< closed; light is inside of it
  ScatteringMedium medium = {};  ///< of the stage, but for the body
  std::optional<Body> body = {};
  double excess_around = 0;
};

/// The same stage where light that collides is lost.
Stage without_scattering(const Stage& stage);

/// The box around a closed surface. Throws InputError for a plane.
Box bounds(const Surface& surface);

/// To rounding: touching is allowed. Of a distance grid, its box.
bool lies_in(const Surface& inner, const Surface& outer);

/// Throws InputError for a boundary or a body that is not closed, a body that is not within the
/// boundary, and a density grid that flights take too long through.
void check(const Stage& stage);

/// Throws InputError for a medium so dense that a path of at most so many scatterings may not end
/// within minutes.
void check_path_lengths(const Stage& stage, int max_scatterings);

/// Throws InputError unless a sensor here is inside the stage or on its boundary, and not in the
/// body.
void require_in_stage(const Stage& stage, const Vec3& x);

/// The relative density of the medium in the body, or around it, averaged over points of a lattice.
double mean_density(const Stage& stage, bool in_body);

}  // namespace flatspeckle::grin
