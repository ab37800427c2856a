#pragma once

#include "grin/media/fields/scene_field.h"
#include "grin/render/stage/stage.h"

namespace flatspeckle::grin {

/// Largest error of a ray due to the step. It applies to the end point, in units of the length of
/// the ray; to the direction, in rad; and to the relative errors of the optical path and of the map
/// to neighbouring rays.
inline constexpr double step_tolerance = 1e-4;

/// Whether the field bends no ray noticeably in the part that it fills.
bool bends_nothing(const SceneField& field, const Stage& stage);

/// Returns the longest step that resolves the variation of the field: a few times its scale, or the
/// size of the part that it fills if it does not bend rays noticeably. Valid for Sharma's
/// integrator with equal steps in sigma (length at index 1).
double longest_step(const SceneField& field, const Stage& stage);

/// Returns the step for which no ray of a pilot run through the part filled by the field has an
/// error above step_tolerance, estimated by halving the step; most errors are ten times smaller.
/// The result depends only on field and stage, and has two digits. any_phase: use the worst phase
/// of the sound.
double chosen_step(const SceneField& field, const Stage& stage, bool any_phase);

/// A step for Sharma's integrator, or for Leapfrog if Leapfrog needs less time for the same length.
struct StepChoice {
  double step;
  bool leapfrogs = false;  ///< whether to use Leapfrog; argument of make_ray_field()
};
StepChoice chosen_steps(const SceneField& field, const Stage& stage, bool any_phase);

}  // namespace flatspeckle::grin
