#pragma once

#include <cmath>
#include <filesystem>
#include <optional>
#include <string>

#include "core/result/invariant.h"
#include "grin/design/problem/design_scene.h"

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
  double rms_as_smooth = HUGE_VAL;      ///< where the roughness' weight was lowered last
  double rms_by_half_steps = HUGE_VAL;  ///< where that was looked at last
  bool ended = false, stalled = false;
  double cpu_before = 0;  ///< of the runs that this one goes on from
};

/// What rays miss by, root mean square over them: those that the search has seen and others, as
/// they are and by steps of half the length, as what is found may lean on the steps' own error.
/// Nothing where a ray is lost.
struct DesignCheck {
  std::optional<double> seen, seen_half_step, held_out, held_out_half_step;
  double start_held_out = 0;  ///< of the field at the start
  std::size_t unseen = 0;  ///< coefficients within the field that no ray of the search depends on
  std::optional<std::vector<double>> readings = {};  ///< of the held-out rays, by the half steps
  double in_place = 0;                               ///< share of these that miss by nothing
  /// Relative difference between derivatives of the readings by reversed rays and by differences.
  std::optional<Invariant> derivatives = {};
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
  /// Coefficients that stand at a bound which is not held.
  std::size_t at_bounds(const DesignState& state) const;

 private:
  template <class Is>
  std::size_t count_free(const DesignState& state, const Is& is) const;
  std::size_t unseen(const DesignState& state);
  std::optional<Invariant> derivatives(const DesignState& state);
  Search search_in(const FieldForm& form) const;
  void note(DesignState& state) const;
  void refine(DesignState& state);
  bool smoothes_on(DesignState& state) const;
  bool leans_on_steps(DesignState& state);
  static std::optional<double> rms(DesignTask& task,
                                   const std::optional<std::vector<double>>& readings);

  const DesignScene& scene_;
  DesignTask seen_, held_out_;
};

/// Where a search that was cut off goes on from: beside its result, NAME.state.
std::filesystem::path state_path(const std::filesystem::path& out);

/// identity: what tells one search from another. Throws IoError.
void save_state(const std::filesystem::path& path, const std::string& identity,
                const DesignState& state);

/// Whether it is there and whole, and of this search.
bool holds(const std::filesystem::path& path, const std::string& identity);

/// Nothing where there is no such file. Throws InputError for one that is damaged, or of another
/// search.
std::optional<DesignState> read_state(const std::filesystem::path& path,
                                      const std::string& identity);

}  // namespace flatspeckle::grin::design
