#pragma once

#include <algorithm>

#include "grin/media/scattering/free_flight.h"

namespace flatspeckle::mc {

/// As grin::StretchedFlight, of flights that stay inside. Without stretched ones the variance has
/// no bound but the depth of the medium, from a pull of 1/2 on.
class BoundedStretchedFlight {
 public:
  BoundedStretchedFlight(double mu_t, double longest, double pull)
      : plain_{mu_t, longest}, pull_(pull) {}

  double sample(double u) const {
    if (pull_ <= 0) return plain_.sample(u);
    return u < 0.5 ? stretched().sample(2 * u) : plain_.sample(2 * u - 1);
  }
  double density(double distance) const {
    if (pull_ <= 0) return plain_.density(distance);
    return (plain_.density(distance) + stretched().density(distance)) / 2;
  }
  /// Of a flight so long: the density of all flights over that of those sampled.
  double weight(double distance) const {
    if (pull_ <= 0) return plain_.probability();
    return plain_.probability() * plain_.density(distance) / density(distance);
  }

 private:
  grin::BoundedFlight stretched() const {
    return {(1 - std::min(pull_, grin::StretchedFlight::most_pull)) * plain_.mu_t, plain_.longest};
  }

  grin::BoundedFlight plain_;
  double pull_;
};

}  // namespace flatspeckle::mc
