#pragma once

#include <optional>
#include <string>
#include <vector>

#include "grin/media/scattering/scattering_medium.h"
#include "grin/rays/surfaces/signed_distance.h"

namespace flatspeckle::grin {

/// Part of the stage: a body, numbered from 1, or 0 for the surroundings of the bodies.
using Part = int;
inline constexpr Part around = 0;

/// Effect of the surface of a body on light: refraction, or reflection or absorption of all light
/// by an opaque body.
enum class BodyFace { refracts, reflects, absorbs };

/// A body in the stage with its own index and medium. At its surface light is refracted and
/// reflected by Fresnel's laws if the index jumps.
struct Body {
  Surface surface;
  ScatteringMedium medium = {};
  std::optional<double> excess = {};  ///< index - 1; nullopt: the index field fills the body
  const char* keys = "body_";         ///< prefix of the keys that define the body, for messages
  BodyFace face = BodyFace::refracts;
  std::string note = {};  ///< note for the user on how the surface was made, if there is one

  bool is_opaque() const { return face != BodyFace::refracts; }
};

/// The volume in which light propagates. Light that reaches the boundary leaves the scene without
/// reflection. Where bodies overlap, the last one in the list counts. The index field fills the
/// first body without an index of its own, and around the bodies the index is 1 + excess_around;
/// without such a body the field fills the surroundings.
struct Stage {
  Surface boundary;              ///< closed; light is inside of it
  ScatteringMedium medium = {};  ///< medium of the surroundings of the bodies
  std::vector<Body> bodies = {};
  double excess_around = 0;

  Part parts() const { return static_cast<Part>(bodies.size()) + 1; }
  /// Returns the surface of a part; for the surroundings, the boundary.
  const Surface& surface(Part part) const {
    return part == around ? boundary : bodies[part - 1].surface;
  }
  const ScatteringMedium& medium_in(Part part) const {
    return part == around ? medium : bodies[part - 1].medium;
  }
  Part field_part() const;
  /// Whether some medium absorbs.
  bool absorbs() const;
  bool has_opaque_bodies() const;
  /// Returns index - 1 of a part that the field does not fill.
  double excess_in(Part part) const {
    return part == around ? excess_around : *bodies[part - 1].excess;
  }
};

/// Returns a copy of the stage in which all extinction is absorption.
Stage without_scattering(const Stage& stage);

/// Whether `inner` is inside `outer`, apart from rounding; they may touch. For an inner surface
/// other than a sphere, the corners of its bounds are checked.
bool lies_in(const Surface& inner, const Surface& outer);

/// Throws InputError for two bodies that coincide, and for a body so thin that crossings of its two
/// sides cannot be distinguished.
void check_bodies(const Stage& stage);

/// Throws InputError for a boundary or a body that is not closed, a body that is not within the
/// boundary, a second body without an index of its own, and a density grid so dense that flights
/// through it take too long.
void check(const Stage& stage);

/// Estimates the number of scatterings until light from the middle of a part leaves it or is
/// absorbed; the largest number over the parts.
double most_scatterings(const Stage& stage);

/// Throws InputError for a medium so dense that a path of at most max_scatterings may not end
/// within minutes.
void check_path_lengths(const Stage& stage, int max_scatterings);

}  // namespace flatspeckle::grin
