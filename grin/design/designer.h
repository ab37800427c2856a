#pragma once

#include "grin/design/design_scene.h"

namespace flatspeckle::grin::design {

/// How far the search was after each of its steps.
struct DesignHistory {
  std::vector<double> rms, traces, cpu_s;
  std::vector<std::uint64_t> coefficients;
};

/// All that a design goes on from.
struct DesignState {
  int level = 0, slow_steps = 0;  ///< in turn
  SearchState search;
  DesignHistory history;
  bool ended = false, stalled = false;
};

/// What rays miss by, root mean square over them: those that the search has seen and others, as
/// they are and by steps of half the length, as what is found may lean on the steps' own error.
/// Nothing where a ray is lost.
struct DesignCheck {
  std::optional<double> seen, seen_half_step, held_out, held_out_half_step;
};

/// Level after level, step after step.
class Designer {
 public:
  explicit Designer(const DesignScene& scene);

  DesignState begin();
  /// One step of the search; a function of the state alone, but for the time it takes.
  void advance(DesignState& state);
  FieldForm form(const DesignState& state) const;
  DesignCheck check(const DesignState& state);

 private:
  void note(DesignState& state) const;
  void refine(DesignState& state);
  std::optional<double> rms(DesignTask& task, const DesignState& state, int parts) const;

  const DesignScene& scene_;
  DesignTask seen_, held_out_;
};

}  // namespace flatspeckle::grin::design
