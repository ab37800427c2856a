#include <algorithm>
#include <array>
#include <cmath>

#include "grin/rays/marching/lane_pool.h"
#include "grin/render/flights/space.h"

namespace flatspeckle::grin {

bool Space::has_lanes() const {
  return setup_->field_part == around && region().surfaces.size() == 1 && !setup_->is_straight &&
         setup_->options.spreading == Spreading::none && field_->has_lanes();
}

/// Flights in SIMD lanes, run by LanePool.
class Space::Lanes {
 public:
  Lanes(const Space& space, const NextFlight& next)
      : space_(space),
        next_(next),
        domain_(space.segment_domain()),
        step_(space.setup_->options.step),
        longest_(space.setup_->options.max_length) {}

  bool begin(int lane, RayState& ray) {
    auto& at = at_[lane];
    const auto start = next_(lane, at.has_flown ? &at.flight : nullptr);
    if (!start) return false;
    at = {.flight = {.point = start->from,
                     .start_direction = start->direction,
                     .direction = start->direction},
          .progress = {next_collision(domain_.medium, 0, *start->random)},
          .random = start->random,
          .has_flown = true};
    collision_[lane] = at.progress.collision;
    ray = start_ray(*space_.field_, start->from.x, start->direction);
    return true;
  }
  /// Advances all rays by equal steps, shortened near a collision or a surface.
  void go(RayLanes& rays, const double* clearance, int steps) const {
    constexpr double margin = 1.15;  // larger than the margin of LanePool
#pragma omp simd
    for (int k = 0; k < grin::lanes; ++k) {
      const double vx = rays.v.x[k], vy = rays.v.y[k], vz = rays.v.z[k];
      const double n = std::sqrt(vx * vx + vy * vy + vz * vz);
      const double collides = (collision_[k] - rays.arc_length[k]) / (steps * n);
      const double leaves = clearance[k] > step_ ? clearance[k] / (margin * steps * n) : step_;
      const double enough = collides < leaves ? collides : leaves;
      rays.step[k] = enough < step_ ? enough : step_;
    }
    space_.field_->advance_lanes(steps, rays);
  }
  double clearance(int, const RayState& ray) const {
    return std::min(-domain_.region.distance(ray.x), longest_ - ray.arc_length);
  }
  /// Handles a lane whose ray is within a fraction of a step of its next tentative collision (not
  /// exactly at it, since the index varies along the ray). Returns whether the flight continues.
  bool passed(int lane, RayLanes& rays, double clearance) {
    const double left = collision_[lane] - rays.arc_length[lane];
    if (!(left < step_ / 8)) return true;
    RayState ray = rays.at(lane);
    const bool goes_on = clearance > 2 * left ? arrive(lane, ray) : go_carefully(lane, few, ray);
    if (goes_on) rays.put(lane, ray);
    return goes_on;
  }
  bool careful(int lane, RayState& ray, double&) {
    // the ray has just left its start on the surface, or is about to leave the region
    return go_carefully(lane, 1, ray);
  }

 private:
  static constexpr int few = LanePool<Lanes>::steps_at_once;

  /// Moves the ray to its next tentative collision and samples whether it is real.
  bool arrive(int lane, RayState& ray) {
    auto& [flight, progress, random, has_flown] = at_[lane];
    for (int i = 0; i < few; ++i) {
      const double left = progress.collision - ray.arc_length;
      if (std::abs(left) < 1e-4 * step_) break;
      space_.field_->advance(left / ray.v.norm(), 1, ray, nullptr);
    }
    if (domain_.medium.collides(ray.x, progress.weight, *random)) return end(lane, ray, false);
    collision_[lane] = progress.collision =
        next_collision(domain_.medium, progress.collision, *random);
    return true;
  }
  bool go_carefully(int lane, int most_steps, RayState& ray) {
    auto& at = at_[lane];
    const SegmentStop stop =
        space_.field_->go_on(domain_, longest_, most_steps, at.progress, *at.random, ray);
    collision_[lane] = at.progress.collision;
    if (stop == SegmentStop::steps) return true;
    return stop == SegmentStop::lost ? false : end(lane, ray, stop == SegmentStop::surface);
  }
  bool end(int lane, const RayState& ray, bool at_surface) {
    auto& at = at_[lane];
    space_.end_segment(at.flight, ray, at.progress.weight);
    at.flight.end = at_surface ? Flight::End::boundary : Flight::End::collision;
    return false;
  }

  struct Flying {
    Flight flight;
    SegmentProgress progress;
    RandomStream* random;
    bool has_flown = false;
  };
  const Space& space_;
  const NextFlight& next_;
  SegmentDomain domain_;
  double step_, longest_;
  std::array<Flying, grin::lanes> at_{};
  /// Arc length of the next tentative collision in each lane, a copy of that in at_.
  alignas(64) double collision_[grin::lanes] = {};
};

void Space::fly_side_by_side(const NextFlight& next) const {
  Lanes all(*this, next);
  LanePool(all).run();
}

}  // namespace flatspeckle::grin
