#pragma once

#include <cmath>

#include "flatland/media/medium_profile.h"

namespace flatspeckle::mc {

/// A free flight from x along w through a medium that varies, under the condition that it is no
/// longer than `longest`.
class ProfileFlight {
 public:
  ProfileFlight(const MediumProfile& profile, Vec x, Vec w, double longest)
      : profile_(profile),
        x_(x),
        w_(w),
        longest_(longest),
        probability_(-std::expm1(-profile.optical_depth(x, w, longest))) {}

  /// Probability of a collision within `longest`. sample() and density() are conditional on this
  /// collision.
  double probability() const { return probability_; }
  double sample(double u) const {
    return profile_.reach(x_, w_, -std::log1p(-u * probability_), longest_);
  }
  /// Density of the length of the flight; 0 if there is no extinction along the ray.
  double density(double distance) const {
    if (probability_ == 0) return 0;
    return profile_.mu_t(x_ + distance * w_) * std::exp(-profile_.optical_depth(x_, w_, distance)) /
           probability_;
  }

 private:
  const MediumProfile& profile_;
  Vec x_, w_;
  double longest_, probability_;
};

}  // namespace flatspeckle::mc
