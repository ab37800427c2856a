#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "flatland/scene/scene.h"
#include "mc/paths/endpoint_factors/faced_endpoints.h"

namespace flatspeckle::mc {

/// Whether reversed paths (coherent backscattering, the R of C14) are included: only if a view can
/// detect coherent backscattering (automatic), always (yes), or never (no).
enum class ReversedPaths { automatic, yes, no };

/// Settings of the Monte Carlo estimator for a scene, selected before the first batch. Each form of
/// scattering (Phase) has its own compiled walk, without code for the other forms.
struct Plan {
  enum class Phase {
    isotropic,
    henyey_greenstein,
    tabulated,
    isotropic_in_space,
    space,
    henyey_greenstein_in_space,
    tabulated_in_space,
    varying,
    graded
  };
  Domain::Kind domain = Domain::Kind::box;
  Phase phase = Phase::isotropic;
  /// false: only magnitudes of fields are computed; sufficient for intensities
  bool phases = true;
  bool reversed = false;  ///< whether reversed paths are included
  bool near = false;      ///< whether some lights or views are points or beams
  /// Whether walkers are split or undergo Russian roulette by the importance at their depth
  bool weighted = false;
  bool rank_k = false;  ///< whether Hermitian rank-k updates compute the full covariance
  /// Whether walks sample paths of one scatterer; otherwise these are integrated by quadrature
  bool sampled_single = true;
  bool single_roulette = false;  ///< whether paths of one scatterer undergo Russian roulette
  /// Expected contribution (ExpectedContribution) below which a path undergoes Russian roulette
  /// before it is scored; 0 if no path does. The unit is the contribution of an isotropic scatterer
  /// next to a view.
  double score_level = 0;
  std::uint64_t paths_per_batch = 0;
  std::vector<ScoredWaves> waves{{}};  ///< waves for which each path is scored

  std::string describe() const;
};

/// Returns the form of scattering in a homogeneous medium.
Plan::Phase phase_of(const Scene& scene);

Plan make_plan(const Scene& scene, ReversedPaths reversed);

/// Throws InputError for scenes that random walks cannot compute: slabs with near endpoints, and
/// media in which a single path takes seconds. weighted: Plan::weighted; if true, this time
/// includes all the paths into which the path splits.
void require_walks(const Scene& scene, bool weighted);

}  // namespace flatspeckle::mc
