#pragma once

#include "grin/design/descent/optimiser.h"

namespace flatspeckle::grin::design {

/// Quasi-Newton steps by the last changes of coefficients and gradient (Nocedal 1980), along which
/// the loss must fall enough (Armijo), kept within the bounds.
class Lbfgs : public Optimiser {
 public:
  using Optimiser::Optimiser;
  SearchStep advance(SearchState& state) override;

 private:
  std::vector<double> gradient_at(SearchState& state) const;
};

}  // namespace flatspeckle::grin::design
