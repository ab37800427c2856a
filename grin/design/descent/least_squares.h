#pragma once

#include "grin/design/descent/optimiser.h"

namespace flatspeckle::grin::design {

/// Gauss-Newton steps with bounds, damped (Levenberg, Marquardt) by the curvature of each
/// coefficient and by the roughness of the step, so that what no ray sees stays smooth; normal
/// equations by conjugate gradients on the stored derivatives of rays.
class LeastSquares : public Optimiser {
 public:
  using Optimiser::Optimiser;
  SearchStep advance(SearchState& state) override;

 private:
  struct Model;
  Model model_at(SearchState& state) const;
  std::vector<double> solve(const Model& model, double damping) const;
  std::vector<double> curved(const Model& model, double damping,
                             std::span<const double> step) const;
};

}  // namespace flatspeckle::grin::design
