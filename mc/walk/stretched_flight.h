#pragma once

#include <algorithm>

#include "grin/media/free_flight.h"

namespace flatspeckle::mc {

/// A flight that stays inside. Where the worth grows along it as exp(pull mu_t s), half of them are
/// stretched (Dwivedi 1982): else long ones, rare and worth all the more, carry the result, and
/// from a pull of 1/2 on its variance has no bound but the depth of the medium.
class StretchedFlight {
 public:
  static constexpr double most_pull = 0.9;

  StretchedFlight(double mu_t, double longest, double pull) : plain_{mu_t, longest}, pull_(pull) {}

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
    return {(1 - std::min(pull_, most_pull)) * plain_.mu_t, plain_.longest};
  }

  grin::BoundedFlight plain_;
  double pull_;
};

}  // namespace flatspeckle::mc
