#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>
#include <variant>
#include <vector>

#include "grin/rays/marching/ray.h"
#include "grin/rays/marching/stepper.h"

namespace flatspeckle::grin {

/// Path of a ray for plots: points evenly spaced in arc length, interpolated by cubics between the
/// ends of steps.
class RayPath {
 public:
  void add(const RayState& ray);
  /// Ends the path at the given state of the ray and removes nodes beyond it.
  void end_with(const RayState& ray);

  /// Returns `count` points, at least 2, from the start to the end of the path.
  std::vector<Vec3> points(std::size_t count) const;

 private:
  struct Node {
    double s;
    Vec3 x, direction;
  };
  static Vec3 between(const Node& a, const Node& b, double s);

  std::vector<Node> nodes_;
};

/// All integrators of rays. To add one, extend only this list.
using Integrators = std::variant<Sharma, Yoshida4, Leapfrog>;

/// Integrator of rays and its step length: `longest` for all steps or, if there is a tolerance,
/// controlled by the estimated error.
struct RaySteps {
  Integrators integrator;
  double longest;
  std::optional<double> tolerance = {};
};

/// Record of a ray while it is traced: length of its next step, its path, and the largest
/// difference between |v| and the index n (C23).
class RayLog {
 public:
  RayLog(const RaySteps& steps, bool keeps_path)
      : steps_(steps), next_(steps.longest / 16), keeps_path_(keeps_path) {}

  /// Number of steps between checks of |v| = n. A check costs as much as a cheap step.
  static constexpr int steps_between_checks = 4;

  /// Includes a difference between |v| and n that was measured elsewhere.
  void record_mismatch(double index_mismatch) {
    index_mismatch_ = std::max(index_mismatch_, index_mismatch);
  }

  void start(const RayState& ray) {
    if (keeps_path_) path_.add(ray);
  }
  /// Records the end of a step. If steps are not controlled by a tolerance, checks |v| = n at
  /// regular intervals.
  template <IndexField F>
  void pass(const F& field, const RayState& ray) {
    if (!steps_.tolerance && ++steps_made_ % steps_between_checks == 0) check_index(field, ray);
    if (keeps_path_) path_.add(ray);
  }
  /// Records the end of the ray. The last recorded step may have gone beyond this end.
  template <IndexField F>
  void end(const F& field, const RayState& ray) {
    if (keeps_path_) path_.end_with(ray);
    check_index(field, ray);
  }

  /// Returns the largest difference between |v| and n along the ray. Controlled steps measure it
  /// before |v| = n is restored.
  double index_mismatch() const { return index_mismatch_; }
  const RayPath& path() const { return path_; }

  const RaySteps& steps() const { return steps_; }
  double& next_step() { return next_; }

 private:
  template <IndexField F>
  void check_index(const F& field, const RayState& ray) {
    // The index is NaN outside the field; this is ignored
    index_mismatch_ = std::max(index_mismatch_, std::abs(ray.v.norm() - index(field, ray.x)));
  }

  const RaySteps& steps_;
  double next_;  ///< length of the next step, if steps are controlled by a tolerance
  bool keeps_path_;
  std::uint64_t steps_made_ = 0;
  double index_mismatch_ = 0;
  RayPath path_;
};

/// Steps for trace(). The RayLog specifies whether steps are equal or controlled by a tolerance,
/// and records them.
template <class Integrator>
class LoggedSteps {
 public:
  explicit LoggedSteps(RayLog& log)
      : log_(log),
        is_controlled_(log.steps().tolerance),
        fixed_{log.steps().longest},
        controlled_{log.steps().tolerance.value_or(0), log.next_step(), log.steps().longest} {}
  ~LoggedSteps() {
    log_.next_step() = controlled_.h;
    log_.record_mismatch(controlled_.index_mismatch);
  }

  template <IndexField F>
  [[gnu::noinline]] void step(const F& field, double h, RayState& ray) const {
    if (is_controlled_)
      controlled_.step(field, h, ray);
    else
      fixed_.step(field, h, ray);
  }
  template <IndexField F>
  double advance(const F& field, RayState& ray) {
    const double h = is_controlled_ ? controlled(field, ray) : equal(field, ray);
    log_.pass(field, ray);
    return h;
  }

 private:
  template <IndexField F>
  [[gnu::flatten]] double controlled(const F& field, RayState& ray) {
    return controlled_.advance(field, ray);
  }
  template <IndexField F>
  [[gnu::flatten]] double equal(const F& field, RayState& ray) {
    return fixed_.advance(field, ray);
  }

  RayLog& log_;
  bool is_controlled_;
  FixedSteps<Integrator> fixed_;
  ControlledSteps<Integrator> controlled_;
};

}  // namespace flatspeckle::grin
