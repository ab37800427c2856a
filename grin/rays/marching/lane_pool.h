#pragma once

#include <array>
#include <cstddef>

#include "grin/rays/marching/ray_lanes.h"

namespace flatspeckle::grin {

/// Rays that are far from everything go on side by side, so many steps at a time; the others take
/// steps one by one. Where a ray is, and how far it may go unseen, is the work's to say:
///   begin(lane, ray)      another ray for a lane, or false where none is left;
///   go(rays, clearance, steps)  steps of all lanes, of which so much is known;
///   clearance(lane, ray)  no more than the arc that is left to what the ray must not pass unseen;
///   passed(lane, rays, clearance)  those steps were made by the lane's ray, and so much is left;
///                         may go on by itself where the ray has come to something. False: it ends;
///   careful(lane, ray, index_mismatch)  makes a few steps by itself, or ends the ray: false.
template <class Work>
class LanePool {
 public:
  static constexpr int steps_at_once = 4;

  explicit LanePool(Work& work) : work_(work) {}

  void run() {
    for (int lane = 0; lane < lanes; ++lane) fill(lane);
    while (active_ > 0) {
      look_ahead();
      before_ = rays_;
      work_.go(rays_, clearance_, steps_at_once);
      spend_clearance();
      for (int lane = 0; lane < lanes; ++lane)
        if (is_active_[lane]) follow(lane);
    }
  }

 private:
  /// Where what is known of the clearance may not be enough.
  void look_ahead() {
    for (int lane = 0; lane < lanes; ++lane)
      if (is_active_[lane] && !(clearance_[lane] > arc_[lane]))
        clearance_[lane] = work_.clearance(lane, rays_.at(lane));
  }

  /// By what the rays have gone.
  void spend_clearance() {
    constexpr double margin = 1.1;  // an integrator's arc is not exact
#pragma omp simd
    for (int k = 0; k < lanes; ++k) {
      const double arc = margin * (rays_.arc_length[k] - before_.arc_length[k]);
      const bool is_known = arc > 0 && rays_.index_mismatch[k] >= 0;  // no NaN
      const bool is_free = is_known && clearance_[k] > arc;
      arc_[k] = is_known ? arc : 0;
      clearance_[k] -= is_free ? arc : 0;
      is_free_[k] = is_free;
    }
  }

  /// Spheres about where the ray was and where it is, with nothing in them, hold all that it may
  /// have gone.
  bool was_free(int lane) {
    if (is_free_[lane] != 0) return true;
    if (!(arc_[lane] > 0)) return false;
    const double before = clearance_[lane];
    clearance_[lane] = work_.clearance(lane, rays_.at(lane));
    return before > 0 && clearance_[lane] > 0 && before + clearance_[lane] > arc_[lane];
  }

  void fill(int lane) {
    RayState ray;
    const bool is_active = work_.begin(lane, ray);
    active_ += is_active - is_active_[lane];
    is_active_[lane] = is_active;
    clearance_[lane] = 0;
    rays_.index_mismatch[lane] = 0;
    if (is_active) rays_.put(lane, ray);
  }

  void follow(int lane) {
    if (was_free(lane)) {
      if (!work_.passed(lane, rays_, clearance_[lane])) fill(lane);
      return;
    }
    RayState ray = before_.at(lane);
    double& mismatch = rays_.index_mismatch[lane] = before_.index_mismatch[lane];
    if (!work_.careful(lane, ray, mismatch)) return fill(lane);
    clearance_[lane] = 0;
    rays_.put(lane, ray);
  }

  Work& work_;
  RayLanes rays_{}, before_;
  /// arc: of the last steps, with a margin; 0 where they failed. free: 1 or 0.
  alignas(64) double clearance_[lanes] = {}, arc_[lanes] = {}, is_free_[lanes] = {};
  std::array<bool, lanes> is_active_{};
  int active_ = 0;
};

}  // namespace flatspeckle::grin
