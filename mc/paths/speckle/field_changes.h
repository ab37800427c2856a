#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "core/numbers/random.h"
#include "flatland/scene/scene.h"
#include "mc/jobs/motion.h"
#include "mc/paths/walk/path_scorer.h"

namespace flatspeckle::mc {

/// Changes of a scene between the fields of a realization, which share their light paths: delays
/// during which the scatterers move, or shifts of the frequency relative to it. Empty lists mean
/// one field without a change.
struct FieldChanges {
  std::vector<double> delays{};
  Motion motion{};  ///< per unit of the delays
  std::vector<double> shifts{};
  bool in_seconds = false;  ///< whether delays are in s

  bool none() const { return delays.empty() && shifts.empty(); }
  /// Returns the largest moves of scatterers along each axis; Brownian motion rarely exceeds them.
  Vec largest_moves(const Scene& scene) const;
  std::size_t count() const { return none() ? 1 : delays.size() + shifts.size(); }
};

/// Sums over the inner scatterers and the free flights of a path: (1 - cos(scattering angle)) times
/// the diffusion, (from - to).velocity, and the length.
struct ChangeTally {
  const LocalMotion* motion = nullptr;
  double turn = 0, slip = 0, length = 0;

  void flight(Vec, Vec, double r) { length += r; }
  void scattering(Vec x, Vec from, Vec to);
};

/// A path after a change: its field is multiplied by `factor`, and in the phases of plane waves and
/// far views its first and last scatterer have moved.
struct ChangedPath {
  Vec first_move, last_move;
  Complex factor = 1;
};

/// Draws the changes of paths. The positions of scatterers at increasing delays are samples of
/// Brownian motion and flow, so that the mean of f(0) conj(f(t)) over the samples is that of
/// delay_job() for each pair of delays, and the pattern changes continuously.
class ChangeDraw {
 public:
  ChangeDraw(const Scene& scene, const FieldChanges& changes);

  ChangeTally no_tally() const { return {&motion_}; }
  /// Draws the changes of a path, with the tally of its inner scatterers.
  std::span<const ChangedPath> draw(const Path& path, const ChangeTally& inner,
                                    RandomStream& random);
  /// Draws the changes of a path of one scatterer.
  std::span<const ChangedPath> draw_single(Vec x, RandomStream& random);

 private:
  /// Draws the moves of a scatterer at x for all delays. A shift of the frequency changes phases as
  /// a move along x does.
  void draw_moves(Vec x, Vec ChangedPath::*move, RandomStream& random);

  FieldChanges changes_;
  LocalMotion motion_;
  double k_;
  int dimension_;
  std::vector<std::size_t> order_;  ///< indices of increasing delays
  std::vector<ChangedPath> paths_;
};

}  // namespace flatspeckle::mc
