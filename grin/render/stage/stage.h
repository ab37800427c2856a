#pragma once

#include <optional>
#include <vector>

#include "grin/media/scattering/scattering_medium.h"
#include "grin/rays/surfaces/signed_distance.h"

namespace flatspeckle::grin {

/// What a place lies in: a body, by its number from 1 on, or what is around them.
using Part = int;
inline constexpr Part around = 0;

/// A thing in the stage, with its own index and medium. At its surface light is refracted and
/// reflected by Fresnel's laws where the index jumps.
struct Body {
  Surface surface;
  ScatteringMedium medium = {};
  std::optional<double> excess = {};  ///< index 1 + excess; nothing: the index field fills it
  const char* keys = "body_";         ///< how names of its keys begin, for messages
};

/// Where light goes. Light that reaches the boundary leaves the scene: nothing is reflected there.
/// Of bodies that overlap a place is in the last one. The index field fills the first body that has
/// no index of its own, and around the bodies the index is 1 + excess_around everywhere; without
/// such a body the field is around them.
struct Stage {
  Surface boundary;              ///< closed; light is inside of it
  ScatteringMedium medium = {};  ///< of the stage, but for the bodies
  std::vector<Body> bodies = {};
  double excess_around = 0;

  Part parts() const { return static_cast<Part>(bodies.size()) + 1; }
  /// Of a part; around the bodies the boundary.
  const Surface& surface(Part part) const {
    return part == around ? boundary : bodies[part - 1].surface;
  }
  const ScatteringMedium& medium_in(Part part) const {
    return part == around ? medium : bodies[part - 1].medium;
  }
  Part field_part() const;
  /// Some medium absorbs.
  bool absorbs() const;
  /// Of a part that the field does not fill.
  double excess_in(Part part) const {
    return part == around ? excess_around : *bodies[part - 1].excess;
  }
};

/// The same stage where light that collides is lost.
Stage without_scattering(const Stage& stage);

/// To rounding: touching is allowed. Of a level surface, its bounds.
bool lies_in(const Surface& inner, const Surface& outer);

/// Throws InputError for bodies that coincide as a whole and for one so thin that crossings of its
/// two sides cannot be told apart.
void check_bodies(const Stage& stage);

/// Throws InputError for a boundary or a body that is not closed, a body that is not within the
/// boundary, a second one without an index, and a density grid that flights take too long through.
void check(const Stage& stage);

/// How often light from the middle of a part scatters at the most, roughly: it goes through,
/// diffuses, or is absorbed.
double most_scatterings(const Stage& stage);

/// Throws InputError for a medium so dense that a path of at most so many scatterings may not end
/// within minutes.
void check_path_lengths(const Stage& stage, int max_scatterings);

}  // namespace flatspeckle::grin
