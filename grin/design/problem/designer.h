#pragma once

#include <cmath>
#include <filesystem>
#include <optional>
#include <string>

#include "core/result/invariant.h"
#include "grin/design/problem/design_scene.h"

namespace flatspeckle::grin::design {

/// Values after each step of the search: residual, number of traces per ray, processor time and
/// number of coefficients.
struct DesignHistory {
  std::vector<double> rms, traces, cpu_s;
  std::vector<std::uint64_t> coefficients;
};

/// State of a search from which it can be resumed.
struct DesignState {
  /// Refinement level, and number of consecutive search steps with little gain.
  int level = 0, slow_steps = 0;
  SearchState search;
  DesignHistory history;
  double rms_as_smooth =
      HUGE_VAL;  ///< root mean square residual when the weight of the roughness was last lowered
  double rms_by_half_steps =
      HUGE_VAL;  ///< root mean square residual with half the integration step, when last computed
  bool ended = false, stalled = false;
  std::string ended_by = {};  ///< the rule by which the search has ended
  double cpu_before = 0;      ///< processor time of earlier runs, seconds
};

/// Root mean square residuals of the rays used in the search (seen) and of held-out rays, with full
/// and half integration steps. The half step reveals a design that exploits integration errors. A
/// residual is nullopt if a ray is lost.
struct DesignCheck {
  std::optional<double> seen, seen_half_step, held_out, held_out_half_step;
  /// Residual of the held-out rays in the field with which the search starts.
  double start_held_out = 0;
  /// Number of coefficients within the field on which no ray of the search depends.
  std::size_t unseen = 0;
  /// Measurements of the held-out rays, traced with half steps.
  std::optional<std::vector<double>> measurements = {};
  double in_place = 0;  ///< fraction of the residuals of the held-out rays that are 0
  /// Relative difference between the derivatives of the measurements computed with reversed rays
  /// and with finite differences.
  std::optional<Invariant> derivatives = {};
};

/// Runs the search step by step, from the coarsest to the finest level.
class Designer {
 public:
  explicit Designer(const DesignScene& scene);

  DesignState begin();
  /// Makes one step of the search; apart from the recorded time, the result depends on the state
  /// alone.
  void advance(DesignState& state);
  FieldForm form(const DesignState& state) const;
  DesignCheck check(const DesignState& state);
  /// Returns the number of free coefficients that are at their lower or upper bound.
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
                                   const std::optional<std::vector<double>>& measurements);

  const DesignScene& scene_;
  DesignTask seen_, held_out_;
};

/// Returns the effective focal length h / sin u' of a designed ball, from a ray at the height h of
/// a tenth of its radius along z, which leaves at the angle u'; nullopt if the ray is lost.
std::optional<double> focal_length(const DesignScene& scene, const Designer& designer,
                                   const DesignState& state);

/// Returns the path of the file from which an interrupted search resumes: the path of its result
/// with ".state" appended.
std::filesystem::path state_path(const std::filesystem::path& out);

/// Saves the state of a search. identity: text that distinguishes the search from others. Throws
/// IoError.
void save_state(const std::filesystem::path& path, const std::string& identity,
                const DesignState& state);

/// Whether the file exists, is intact and belongs to the search with this identity.
bool holds(const std::filesystem::path& path, const std::string& identity);

/// Reads the state of a search; nullopt if there is no such file. Throws InputError if the file is
/// damaged or belongs to another search.
std::optional<DesignState> read_state(const std::filesystem::path& path,
                                      const std::string& identity);

}  // namespace flatspeckle::grin::design
