#pragma once

#include <optional>
#include <vector>

#include "grin/media/scattering/scattering_medium.h"
#include "grin/render/transport/depth_importance.h"
#include "grin/render/transport/path_vertex.h"
#include "grin/render/transport/transport_counts.h"

namespace flatspeckle::grin {

// The classes below update the weight of a path at a collision. The flight before it began at
// `here` and ended at `next`, whose weight already includes absorption. collide() returns whether a
// path continues from `next`.

/// Throughput below which absorption ends paths by Russian roulette instead of reducing their
/// weight, so that no path continues with a very small weight.
inline constexpr double capture_level = 0.25;

/// A path that is never split.
class UnsplitPath {
 public:
  static constexpr bool is_split() { return false; }
  void begin(const PathVertex&, const Vec3&) { throughput_ = 1; }
  const Vec3* log_gradient() const { return nullptr; }
  FlightLog* log() const { return nullptr; }
  void bias(double) {}
  void flew(double, const PathVertex&, const Flight&) {}
  void turned(const PathVertex&, const Vec3&) {}

  template <class Tally>
  bool collide(const PathVertex& here, const Flight& flight, const ScatteringMedium& medium,
               PathVertex& next, RandomStream& random, const TransportCounts&, Tally& tally) {
    const double albedo = medium.albedo(), survives = flight.weight * albedo;
    if (throughput_ * survives >= capture_level) {
      tally.absorbed(here, flight, albedo);
      throughput_ *= survives;
    } else if (random.uniform() >= survives) {
      tally.ended(here, flight, albedo);
      return false;
    } else {
      next.weight = here.weight;
    }
    return true;
  }
  bool next(PathVertex&) { return false; }

 private:
  double throughput_ = 1;
};

/// All branches of a path that is split where the importance grows and undergoes Russian roulette
/// where it falls (weight windows). MIS weights do not depend on the splitting: they still sum to 1
/// for each path.
class SplitTree {
 public:
  static constexpr bool is_split() { return true; }
  /// Holds references to the importance and to the sums of its control variates.
  SplitTree(const DepthImportance& importance, ControlVariates::Sums& sums)
      : importance_(importance) {
    if (importance.control_variates()) controls_.emplace(*importance.control_variates(), sums);
  }

  void begin(const PathVertex& start, const Vec3& direction) {
    throughput_ = 1;
    waiting_.clear();
    log_gradient_ = importance_.importance_and_gradient(start.point).log_gradient;
    if (controls_) controls_->begin(start.point, direction);
  }
  /// Gradient of log(importance) at the current vertex, which biases free flights.
  const Vec3* log_gradient() const { return &log_gradient_; }
  /// Returns the log that the control variates need of the next flight, or null.
  FlightLog* log() { return controls_ ? controls_->log() : nullptr; }
  void bias(double factor) { throughput_ *= factor; }

  /// Adds a flight to the control variates. before: weight of the path before the flight, without
  /// the factor for biased sampling.
  void flew(double before, const PathVertex& here, const Flight& flight) {
    if (controls_) controls_->flew(before, here.weight, flight);
  }
  void turned(const PathVertex& here, const Vec3& direction) {
    if (controls_) controls_->turned(here, direction);
  }

  template <class Tally>
  bool collide(const PathVertex& here, const Flight& flight, const ScatteringMedium& medium,
               PathVertex& next, RandomStream& random, const TransportCounts& counts,
               Tally& tally) {
    const double albedo = medium.albedo();
    tally.absorbed(here, flight, albedo);
    throughput_ *= flight.weight * albedo;
    const auto [importance, log_gradient] = importance_.importance_and_gradient(next.point);
    log_gradient_ = log_gradient;
    const double expected = throughput_ * importance;
    if (expected < 0.5) return survives(expected, medium, next, random, tally);
    if (expected > 2 && counts.flights < last_splitting) split(expected, next);
    return true;
  }

  /// Sets `vertex` to the start of a branch that has not been traced yet; returns false if there is
  /// none.
  bool next(PathVertex& vertex) {
    if (waiting_.empty()) return false;
    Waiting& last = waiting_.back();
    vertex = last.vertex;
    throughput_ = last.throughput;
    log_gradient_ = last.log_gradient;
    if (controls_) controls_->go_to(last.at);
    if (--last.copies == 0) waiting_.pop_back();
    return true;
  }

 private:
  struct Waiting {
    PathVertex vertex;
    Vec3 log_gradient;
    PathControls::Place at;
    double throughput;
    int copies;
  };
  /// Number of flights of a batch after which no path is split: if the importance is overestimated,
  /// trees would grow without bound. The limit does not bias the mean, since each decision to split
  /// depends only on earlier flights.
  static constexpr std::uint64_t last_splitting = 4'000'000;

  template <class Tally>
  bool survives(double probability, const ScatteringMedium& medium, PathVertex& next,
                RandomStream& random, Tally& tally) {
    const double before = next.weight;
    next.weight = random.uniform() < probability ? before / probability : 0;
    throughput_ /= probability;
    if (controls_) controls_->reweighed(next.weight - before);
    tally.reweighed(next.point.part, medium.mu_a > 0, before - next.weight);
    return next.weight > 0;
  }
  void split(double expected, PathVertex& next) {
    constexpr double most_copies = 64;
    const int copies = static_cast<int>(std::min(expected, most_copies));
    next.weight /= copies;
    throughput_ /= copies;
    const auto at = controls_ ? controls_->place() : PathControls::Place{};
    waiting_.push_back({next, log_gradient_, at, throughput_, copies - 1});
  }

  const DepthImportance& importance_;
  std::optional<PathControls> controls_;
  double throughput_ = 1;
  Vec3 log_gradient_ = Vec3::Zero();
  std::vector<Waiting> waiting_;
};

}  // namespace flatspeckle::grin
