#pragma once

#include <vector>

#include "core/numbers/random.h"
#include "flatland/scene/scene.h"
#include "mc/paths/endpoint_factors/endpoint_factors.h"

namespace flatspeckle::mc {

/// Whether the plane waves along `others` represent the plane wave along w. They do if, at every
/// place of the medium, one of those whose direction differs from w by at most `spacing` (radians)
/// is at most exp(1.5) times more attenuated than the wave along w. By reciprocity the result also
/// holds for light that leaves the medium along -w.
bool reached(const Scene& scene, Vec w, const std::vector<Vec>& others, double spacing);

/// Importance of a depth for the views: the fraction of the light at that depth that reaches the
/// views, by diffusion theory, relative to the same fraction at one mean free path inside the face
/// where the light enters. Walkers are split where the importance grows and undergo Russian
/// roulette where it falls, so that all contributions have similar weights. The importance changes
/// only the variance of the result.
class DiffusionImportance {
 public:
  explicit DiffusionImportance(const Scene& scene);

  double log_importance(double z) const;
  /// Returns the derivative of the log importance with respect to depth, by which free flights are
  /// biased. It is set to 0 if the importance grows so little over the medium that biased flights
  /// cost more than they gain.
  double derivative(double z) const;
  /// Returns the mean derivative of the log importance over all depths, for biasing the flight to
  /// the first scatterer. It is set to 0 if the bias gains nothing.
  double mean_derivative() const;
  bool steep() const { return steep_; }
  /// Whether diffuse light decays exponentially, by absorption or through the sides of a box.
  /// Otherwise (as in a lossless slab, which light leaves only through the faces) walkers of equal
  /// weight are as efficient as weighted ones, however thick the medium is.
  bool is_attenuated() const { return is_attenuated_; }
  /// Returns the mean number of scatterings of a path, summed over all the paths into which it
  /// splits, by diffusion theory.
  double scatterings() const { return scatterings_; }

 private:
  std::size_t interval(double z) const;

  double step_;
  bool steep_ = false, is_attenuated_ = false;
  double scatterings_ = 0;
  std::vector<double> log_importance_;  ///< log importance at equally spaced depths
};

/// Returns the score level (Plan::score_level) of a thick medium: twice the mean square of the
/// phase function divided by the square of its mean. Measurements in 2D show that this is near the
/// optimum, which is flat.
double score_level(double g, int dimension);

/// Estimates the contribution of a path from its last scatterer and the direction in which the path
/// arrives there, up to a constant factor. The estimate is the largest product of attenuation and
/// phase function towards any of a few representative endpoints. Computing a contribution costs far
/// more than a step of a walk, so small contributions undergo Russian roulette before they are
/// computed.
class ExpectedContribution {
 public:
  ExpectedContribution(const Scene& scene, const std::vector<Endpoint>& endpoints);

  /// Returns the estimate, which is about 1 for isotropic scattering where little medium lies
  /// between x and an endpoint.
  double operator()(Vec x, Vec arrival) const;

 private:
  Domain domain_;
  Extinction extinction_;
  int dimension_;
  double g_;
  /// Factor of all estimates, by which they keep their relation to the score level if the lobe of
  /// the phase function is made wider.
  double level_ = 1;
  std::vector<Vec> towards_;
  bool always_ = false;  ///< true if an endpoint is near; the estimate is then 1 everywhere
};

}  // namespace flatspeckle::mc
