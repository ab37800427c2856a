#pragma once

#include "grin/design/descent/optimiser.h"

namespace flatspeckle::grin::design {

/// Kingma and Ba 2015, kept within the bounds: what published programs of inverse design by rays
/// use, to be compared with.
class Adam : public Optimiser {
 public:
  using Optimiser::Optimiser;
  SearchStep advance(SearchState& state) override;
};

}  // namespace flatspeckle::grin::design
