#pragma once

#include <array>
#include <cstddef>

#include "grin/rays/marching/ray_lanes.h"

namespace flatspeckle::grin {

/// Traces rays in SIMD lanes. Rays far from all surfaces make steps_at_once steps together; the
/// other rays step one by one. The clearance of a ray is a lower bound of its arc length to the
/// next surface or to its end. Work provides the rays and their clearances by these functions:
///   begin(lane, ray): starts another ray in a lane; returns false if no ray is left;
///   go(rays, clearance, steps): makes steps in all lanes; `clearance` is known for each lane;
///   clearance(lane, ray): returns the clearance of a ray;
///   passed(lane, rays, clearance): is called after these steps if the ray of a lane has met no
///     surface; `clearance` is what remains. It may continue the ray alone. Returns false if the
///     ray has ended;
///   careful(lane, ray, index_mismatch): makes a few steps with tests for crossings. Returns false
///     if the ray has ended.
template <class Work>
class LanePool {
 public:
  static constexpr int steps_at_once = 4;

  explicit LanePool(Work& work) : work_(work) {}

  void run() {
    for (int lane = 0; lane < lanes; ++lane) fill(lane);
    while (active_ > 0) {
      refresh_clearances();
      before_ = rays_;
      work_.go(rays_, clearance_, steps_at_once);
      spend_clearance();
      for (int lane = 0; lane < lanes; ++lane)
        if (is_active_[lane]) follow(lane);
    }
  }

 private:
  /// Recomputes clearances of rays that may be too short for the next steps.
  void refresh_clearances() {
    for (int lane = 0; lane < lanes; ++lane)
      if (is_active_[lane] && !(clearance_[lane] > arc_[lane]))
        clearance_[lane] = work_.clearance(lane, rays_.at(lane));
  }

  /// Reduces the clearances of all rays by the arc lengths of their last steps.
  void spend_clearance() {
    constexpr double margin = 1.1;  // the arc length of an integrator is not exact
#pragma omp simd
    for (int k = 0; k < lanes; ++k) {
      const double arc = margin * (rays_.arc_length[k] - before_.arc_length[k]);
      const bool is_known = arc > 0 && rays_.index_mismatch[k] >= 0;  // false for NaN
      const bool is_free = is_known && clearance_[k] > arc;
      arc_[k] = is_known ? arc : 0;
      clearance_[k] -= is_free ? arc : 0;
      is_free_[k] = is_free;
    }
  }

  /// Whether the last steps of a ray met no surface, because they lie within two spheres that
  /// contain no surface. The spheres are centred at the start and the end of these steps.
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
  /// For each lane: clearance of its ray (clearance_), arc length of the last steps with a margin,
  /// 0 if they failed (arc_), and 1 if these steps met no surface, otherwise 0 (is_free_).
  alignas(64) double clearance_[lanes] = {}, arc_[lanes] = {}, is_free_[lanes] = {};
  std::array<bool, lanes> is_active_{};
  int active_ = 0;
};

}  // namespace flatspeckle::grin
