#include <algorithm>
#include <array>
#include <cmath>

#include "grin/rays/marching/lane_pool.h"
#include "grin/render/flights/space.h"

namespace flatspeckle::grin {

bool Space::has_lanes() const {
  return setup_->field_part == around && room().surfaces.size() == 1 && !setup_->is_straight &&
         setup_->options.spreading == Spreading::none && field_->has_lanes();
}

/// LanePool's work.
class Space::Lanes {
 public:
  Lanes(const Space& space, const NextFlight& next)
      : space_(space),
        next_(next),
        room_(space.leg_room()),
        step_(space.setup_->options.step),
        longest_(space.setup_->options.max_length) {}

  bool begin(int lane, RayState& ray) {
    auto& at = at_[lane];
    const auto start = next_(lane, at.has_flown ? &at.flight : nullptr);
    if (!start) return false;
    at = {.flight = {.point = start->from,
                     .start_direction = start->direction,
                     .direction = start->direction},
          .progress = {next_collision(room_.medium, 0, *start->random)},
          .random = start->random,
          .has_flown = true};
    collision_[lane] = at.progress.collision;
    ray = start_ray(*space_.field_, start->from.x, start->direction);
    return true;
  }
  /// Towards a collision or a surface that is near, equal shorter ones.
  void go(RayLanes& rays, const double* clearance, int steps) const {
    constexpr double margin = 1.15;  // of LanePool, and more
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
    return std::min(-room_.room.distance(ray.x), longest_ - ray.arc_length);
  }
  /// At a collision they are within a small part of a step, as the index varies on the way.
  bool passed(int lane, RayLanes& rays, double clearance) {
    const double left = collision_[lane] - rays.arc_length[lane];
    if (!(left < step_ / 8)) return true;
    RayState ray = rays.at(lane);
    const bool goes_on = clearance > 2 * left ? arrive(lane, ray) : go_carefully(lane, few, ray);
    if (goes_on) rays.put(lane, ray);
    return goes_on;
  }
  bool careful(int lane, RayState& ray, double&) {
    return go_carefully(lane, 1, ray);  // off the surface it started on, or out
  }

 private:
  static constexpr int few = LanePool<Lanes>::steps_at_once;

  /// The tentative collision that is next: near to where it was drawn.
  bool arrive(int lane, RayState& ray) {
    auto& [flight, progress, random, has_flown] = at_[lane];
    for (int i = 0; i < few; ++i) {
      const double left = progress.collision - ray.arc_length;
      if (std::abs(left) < 1e-4 * step_) break;
      space_.field_->advance(left / ray.v.norm(), 1, ray, nullptr);
    }
    if (room_.medium.collides(ray.x, progress.weight, *random)) return end(lane, ray, false);
    collision_[lane] = progress.collision =
        next_collision(room_.medium, progress.collision, *random);
    return true;
  }
  bool go_carefully(int lane, int most_steps, RayState& ray) {
    auto& at = at_[lane];
    const LegStop stop =
        space_.field_->go_on(room_, longest_, most_steps, at.progress, *at.random, ray);
    collision_[lane] = at.progress.collision;
    if (stop == LegStop::steps) return true;
    return stop == LegStop::lost ? false : end(lane, ray, stop == LegStop::surface);
  }
  bool end(int lane, const RayState& ray, bool at_surface) {
    auto& at = at_[lane];
    space_.end_leg(at.flight, ray, at.progress.weight);
    at.flight.end = at_surface ? Flight::End::boundary : Flight::End::collision;
    return false;
  }

  struct Flying {
    Flight flight;
    LegProgress progress;
    RandomStream* random;
    bool has_flown = false;
  };
  const Space& space_;
  const NextFlight& next_;
  LegRoom room_;
  double step_, longest_;
  std::array<Flying, grin::lanes> at_{};
  alignas(64) double collision_[grin::lanes] = {};  ///< tentative, that of at_
};

void Space::fly_side_by_side(const NextFlight& next) const {
  Lanes all(*this, next);
  LanePool(all).run();
}

}  // namespace flatspeckle::grin
