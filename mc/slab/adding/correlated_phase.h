#pragma once

#include "flatland/media/medium.h"
#include "grin/media/scattering/mie_phase.h"

namespace flatspeckle::mc {

/// Phase function p S / mean(S) of equal spheres whose positions have the structure factor S (C16),
/// where p is the phase function of one sphere and mean(S) the mean of S over p. S is taken at the
/// momentum transfer q = 2 k sin(angle / 2).
class CorrelatedPhase {
 public:
  /// k: wavenumber around the spheres.
  CorrelatedPhase(grin::MiePhase alone, StructureFactor structure, double k);

  double density(double cosine) const {
    return alone_.density(cosine) * structure_at(1 - cosine) / mean_structure_;
  }
  /// Samples p and accepts the angle with probability S / max(S).
  double one_minus_cosine(RandomStream& random) const;
  double mean_cosine() const { return mean_cosine_; }
  /// Returns the mean of S over p, by which correlations multiply the scattering coefficient.
  double mean_structure() const { return mean_structure_; }

 private:
  double structure_at(double one_minus_cosine) const;

  grin::MiePhase alone_;
  StructureFactor structure_;
  double k_, largest_, mean_structure_ = 1, mean_cosine_ = 0;
};

}  // namespace flatspeckle::mc
