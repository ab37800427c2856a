#pragma once

#include <cmath>

#include "flatland/media/medium_profile.h"

namespace flatspeckle::mc {

/// A flight through a medium that varies, no longer than `longest`.
class ProfileFlight {
 public:
  ProfileFlight(const MediumProfile& profile, Vec2 x, Vec2 w, double longest)
      : profile_(profile),
        x_(x),
        w_(w),
        longest_(longest),
        probability_(-std::expm1(-profile.optical_depth(x, w, longest))) {}

  /// Of ending in a collision; all that follows is on that condition.
  double probability() const { return probability_; }
  double sample(double u) const {
    return profile_.reach(x_, w_, -std::log1p(-u * probability_), longest_);
  }
  /// 0 where nothing is met on the way.
  double density(double distance) const {
    if (probability_ == 0) return 0;
    return profile_.mu_t(x_ + distance * w_) * std::exp(-profile_.optical_depth(x_, w_, distance)) /
           probability_;
  }

 private:
  const MediumProfile& profile_;
  Vec2 x_, w_;
  double longest_, probability_;
};

}  // namespace flatspeckle::mc
