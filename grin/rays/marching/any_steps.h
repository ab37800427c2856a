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

/// What a ray passes, so that it can be drawn: points evenly spaced in arc length, by cubics
/// between steps.
class RayPath {
 public:
  void add(const RayState& ray);
  /// The ray goes no farther than here; what was added beyond does not count.
  void end_with(const RayState& ray);

  /// From first to last; count >= 2.
  std::vector<Vec3> points(std::size_t count) const;

 private:
  struct Node {
    double s;
    Vec3 x, direction;
  };
  static Vec3 between(const Node& a, const Node& b, double s);

  std::vector<Node> nodes_;
};

/// All integrators; the one list of them.
using Integrators = std::variant<Sharma, Yoshida4, Leapfrog>;

/// Steps of equal length, or controlled by a tolerance.
struct RaySteps {
  Integrators integrator;
  double longest;
  std::optional<double> tolerance = {};
};

/// How a ray is followed, and what is to be known of it on its way.
class RayLog {
 public:
  RayLog(const RaySteps& steps, bool keeps_path)
      : steps_(steps), next_(steps.longest / 16), keeps_path_(keeps_path) {}

  /// Steps from one look at the index to the next: a look costs as much as a cheap step.
  static constexpr int steps_unseen = 4;

  /// Takes what others have seen of its steps.
  void met(double index_mismatch) { index_mismatch_ = std::max(index_mismatch_, index_mismatch); }

  void start(const RayState& ray) {
    if (keeps_path_) path_.add(ray);
  }
  /// At the end of a step, of one that is not controlled with a look at the index.
  template <IndexField F>
  void pass(const F& field, const RayState& ray) {
    if (!steps_.tolerance && ++steps_made_ % steps_unseen == 0) look(field, ray);
    if (keeps_path_) path_.add(ray);
  }
  /// Here, whatever the steps went beyond.
  template <IndexField F>
  void end(const F& field, const RayState& ray) {
    if (keeps_path_) path_.end_with(ray);
    look(field, ray);
  }

  /// Largest ||v| - n| on the way, of controlled steps before it is restored.
  double index_mismatch() const { return index_mismatch_; }
  const RayPath& path() const { return path_; }

  const RaySteps& steps() const { return steps_; }
  double& next_step() { return next_; }

 private:
  template <IndexField F>
  void look(const F& field, const RayState& ray) {
    // NaN, beyond the last index, is not kept
    index_mismatch_ = std::max(index_mismatch_, std::abs(ray.v.norm() - index(field, ray.x)));
  }

  const RaySteps& steps_;
  double next_;  ///< of controlled steps
  bool keeps_path_;
  std::uint64_t steps_made_ = 0;
  double index_mismatch_ = 0;
  RayPath path_;
};

/// Steps that trace() takes, equal or controlled as the log says, and that the log is told of.
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
    log_.met(controlled_.index_mismatch);
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
