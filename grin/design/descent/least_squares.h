#pragma once

#include <utility>
#include <vector>

#include "grin/design/descent/objective.h"

namespace flatspeckle::grin::design {

/// Gauss-Newton steps with bounds, damped (Levenberg, Marquardt) by the curvature of each
/// coefficient and by the roughness of the step, so that what no ray sees stays smooth; normal
/// equations by conjugate gradients on the stored derivatives of rays.
class LeastSquares {
 public:
  LeastSquares(const Objective& objective, Search search)
      : objective_(objective), search_(std::move(search)) {}

  /// A step; a function of the state alone.
  SearchStep advance(SearchState& state) const;

 private:
  struct Model;
  Model model_at(SearchState& state) const;
  std::vector<double> solve(const Model& model, double damping) const;
  std::vector<double> curved(const Model& model, double damping,
                             std::span<const double> step) const;

  Objective objective_;
  Search search_;
};

}  // namespace flatspeckle::grin::design
