#pragma once

#include <optional>
#include <vector>

#include "apps/command_line.h"
#include "apps/medium_options.h"
#include "apps/scene_field.h"
#include "grin/space/stage.h"

namespace flatspeckle::apps {

/// The stage of light and the body in it as the user writes them.
struct StageSpec {
  std::vector<double> stage_box, stage_sphere, body_box, body_sphere;
  std::optional<double> index_around;
  MediumSpec medium, body_medium;
};

void add_stage_options(Options& options, StageSpec& spec);

/// A stage and the index field that light meets in it.
struct FilledStage {
  grin::Stage stage;
  SceneField field;
};

/// A Luneburg ball in a larger stage is a body by itself. Throws InputError, also for a field that
/// has no index above 0 somewhere in its part of the stage.
FilledStage make_stage(const Subcommand& command, const StageSpec& spec,
                       const IndexFieldSpec& field);

/// The box around a sphere or box.
grin::Box bounds(const grin::Surface& surface);

}  // namespace flatspeckle::apps
