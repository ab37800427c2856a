#pragma once

#include <cstdint>
#include <string>

#include "flatland/scene/scene.h"

namespace flatspeckle::mc {

/// Whether reversed paths (coherent backscattering, the R of C14) are walked: where a view asks for
/// them, always, never.
enum class ReversedPaths { automatic, yes, no };

/// What a scene asks of the estimator, derived before the first batch. Each choice picks a kernel
/// that has no code for what is left out.
struct Plan {
  enum class Phase { isotropic, henyey_greenstein, tabulated, space, varying, graded };
  Domain::Kind domain = Domain::Kind::box;
  Phase phase = Phase::isotropic;
  bool phases = true;            ///< false: magnitudes alone, which is all that intensities need
  bool reversed = false;         ///< paths count walked backwards too
  bool near = false;             ///< some lights or views are points, or beams
  bool weighted = false;         ///< walkers split and play roulette: absorption, depth
  bool rank_k = false;           ///< the full covariance by Hermitian rank-k updates
  bool sampled_single = true;    ///< false: paths of one scatterer by quadrature
  bool single_roulette = false;  ///< those of one scatterer play it, too
  /// Expected contribution, in units of that of an isotropic scatterer next to a view, below which
  /// scoring is left to chance; 0: never.
  double score_level = 0;
  std::uint64_t paths_per_batch = 0;

  std::string describe() const;
};

/// Which form of scattering a scatterer of the plane needs.
Plan::Phase phase_of(const Scatterer& scatterer);

Plan make_plan(const Scene& scene, ReversedPaths reversed);

/// Throws InputError where walks cannot be used: near ends beside a slab, and media in which a
/// single path, or all that one splits into where walkers are weighted, takes seconds.
void require_walks(const Scene& scene, bool weighted);

}  // namespace flatspeckle::mc
