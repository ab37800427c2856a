#pragma once

#include <array>
#include <cstddef>

#include "grin/rays/ray_lanes.h"

namespace flatspeckle::grin {

/// Rays that are far from everything go on side by side, so many equal steps at a time; the others
/// take the same steps one by one. Where a ray is, and how far it may go unseen, is the work's to
/// say:
///   begin(lane, ray)      another ray for a lane, or false where none is left;
///   go(rays, steps)       equal steps of all lanes;
///   clearance(lane, ray)  no more than the arc that is left to what the ray must not pass unseen;
///   passed(lane)          those steps were made by the lane's ray;
///   careful(lane, ray, index_mismatch)  makes so many steps one by one, or ends the ray: false.
template <class Work>
class LanePool {
 public:
  static constexpr int steps_at_once = 8;

  explicit LanePool(Work& work) : work_(work) {}

  void run() {
    for (int lane = 0; lane < lanes; ++lane) fill(lane);
    while (active_ > 0) {
      before_ = rays_;
      work_.go(rays_, steps_at_once);
      for (int lane = 0; lane < lanes; ++lane)
        if (is_active_[lane]) follow(lane);
    }
  }

 private:
  void fill(int lane) {
    RayState ray;
    const bool is_active = work_.begin(lane, ray);
    active_ += is_active - is_active_[lane];
    is_active_[lane] = is_active;
    clearance_[lane] = 0;
    rays_.index_mismatch[lane] = 0;
    if (is_active) rays_.put(lane, ray);
  }

  /// A sphere about where the ray was, with nothing in it, holds all that it may have gone.
  void follow(int lane) {
    constexpr double margin = 1.1;  // an integrator's arc is not exact
    const double arc = margin * (rays_.arc_length[lane] - before_.arc_length[lane]);
    if (arc > 0) {
      if (!(clearance_[lane] > arc)) clearance_[lane] = work_.clearance(lane, before_.at(lane));
      if (clearance_[lane] > arc) {
        clearance_[lane] -= arc;
        return work_.passed(lane);
      }
    }
    RayState ray = before_.at(lane);
    double& mismatch = rays_.index_mismatch[lane] = before_.index_mismatch[lane];
    if (!work_.careful(lane, ray, mismatch)) return fill(lane);
    clearance_[lane] = 0;
    rays_.put(lane, ray);
  }

  Work& work_;
  RayLanes rays_{}, before_;
  std::array<double, lanes> clearance_{};
  std::array<bool, lanes> is_active_{};
  int active_ = 0;
};

}  // namespace flatspeckle::grin
