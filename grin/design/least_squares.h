#pragma once

#include <functional>
#include <vector>

#include "grin/design/goal.h"
#include "grin/design/ray_system.h"

namespace flatspeckle::grin::design {

/// How coefficients are sought.
struct Search {
  double least, most;    ///< of each coefficient
  double roughness = 0;  ///< weight of it in the loss, relative to what rays tell on average
  double first_damping = 1e-2;
  double smooth_damping = 0.1;  ///< weight of a step's roughness in its damping
  int solver_steps = 30;        ///< of conjugate gradients, for each step of the search
};

/// Where a search is. The loss is the mean over the rays of the sum of squares of the residuals.
struct SearchState {
  std::vector<double> coefficients;
  double damping, loss = 0;
  long traces = 0;  ///< of each ray, forward or backward
};

enum class SearchStep {
  better,
  settled,  ///< no more to be gained
  stalled   ///< what the linear model promises is not there
};

/// Gauss-Newton steps with bounds, damped (Levenberg, Marquardt) by the curvature of each
/// coefficient and by the roughness of the step, so that what no ray sees stays smooth; normal
/// equations by conjugate gradients on the stored derivatives of rays.
class LeastSquares {
 public:
  LeastSquares(RaySystem& rays, Goal& goal, const FieldForm& form, const Search& search);

  /// Throws InputError where a ray is lost in the field of these coefficients.
  SearchState begin(std::vector<double> coefficients);
  /// A function of the state alone.
  SearchStep advance(SearchState& state);

 private:
  struct Model;
  double loss_of(std::span<const double> residuals) const;
  Model model_at(SearchState& state);
  std::vector<double> solve(const Model& model, double damping) const;
  std::vector<double> curved(const Model& model, double damping,
                             std::span<const double> step) const;

  RaySystem& rays_;
  Goal& goal_;
  FieldForm form_;
  Search search_;
};

}  // namespace flatspeckle::grin::design
