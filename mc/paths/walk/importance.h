#pragma once

#include <vector>

#include "core/numbers/random.h"
#include "flatland/scene/scene.h"
#include "mc/paths/endpoint_factors/end_factors.h"

namespace flatspeckle::mc {

/// Whether a plane wave along w is represented by others: wherever it reaches in the medium, one of
/// them whose direction differs by `spacing` (radians) at the most is weakened by no more than a
/// factor of exp(1.5) beyond it. By reversal the same holds for light that leaves along -w.
bool reached(const Scene& scene, Vec2 w, const std::vector<Vec2>& others, double spacing);

/// What a walker at a depth is worth to the far views: the share of its light that leaves the
/// medium on their sides, by diffusion theory, relative to a mean free path from where the light
/// enters. Walkers are split where it rises and play roulette where it falls, so that all
/// contributions weigh alike. It changes the variance alone.
class DiffusionImportance {
 public:
  explicit DiffusionImportance(const Scene& scene);

  double log_worth(double z) const;
  /// Its derivative, for stretching flights: 0 where the worth rises so little in all that
  /// stretched ones cost more than they give.
  double slope(double z) const;
  /// The mean slope, for stretching the light's flight to the first scatterer: 0 where that gains
  /// nothing.
  double rise() const;
  bool steep() const { return steep_; }
  /// Whether light dies out exponentially, not only as by the faces of a lossless slab: there
  /// walkers of equal weight are as good at any depth.
  bool dies_out() const { return dies_out_; }
  /// Of a path and all that it splits into, on the mean, by diffusion theory.
  double scatterings() const { return scatterings_; }

 private:
  std::size_t interval(double z) const;

  double step_;
  bool steep_ = false, dies_out_ = false;
  double scatterings_ = 0;
  std::vector<double> log_worth_;  ///< at equally spaced depths
};

/// What a scatterer at the end of a path is likely to contribute, up to a factor: the largest
/// attenuation times phase function towards any of a few representative ends. Contributions cost
/// far more than steps, so small ones play roulette before they are computed.
class ExpectedContribution {
 public:
  ExpectedContribution(const Scene& scene, const std::vector<End>& ends);

  /// About 1 where an end is near and scattering is isotropic. Direction: Vec2 or SpaceDirection.
  template <typename Direction>
  double operator()(Vec2 x, const Direction& arrival) const;

 private:
  Domain domain_;
  Extinction extinction_;
  double g_;
  std::vector<Vec2> towards_;
  bool always_ = false;  ///< near ends: no guess
};

}  // namespace flatspeckle::mc
