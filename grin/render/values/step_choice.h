#pragma once

#include "grin/media/fields/scene_field.h"
#include "grin/render/stage/stage.h"

namespace flatspeckle::grin {

/// What a step may do to a ray: of where it ends, by its length; of its direction, rad; of its
/// optical path and of the map that spreads its neighbours, relative.
inline constexpr double step_tolerance = 1e-4;

/// No ray through what the field fills, in so far as it matters.
bool bends_nothing(const SceneField& field, const Stage& stage);

/// So long that what varies is not jumped over: a few of the field's scales, or the size of what it
/// fills where it bends rays by nothing that matters. For equal steps of Sharma in sigma (length
/// at index 1).
double longest_step(const SceneField& field, const Stage& stage);

/// The step by which no ray of a pilot errs by more than step_tolerance over its way through what
/// the field fills, as halving it tells; most err ten times less. A function of field and stage
/// alone, to two digits. any_phase: of the sound, at the worst one.
double chosen_step(const SceneField& field, const Stage& stage, bool any_phase);

/// The same, or such steps of Leapfrog where these cost less for the same way.
struct StepChoice {
  double step;
  bool leapfrogs = false;  ///< make_ray_field()
};
StepChoice chosen_steps(const SceneField& field, const Stage& stage, bool any_phase);

}  // namespace flatspeckle::grin
