#pragma once

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
  /// Holds references to the importance and to the sum of its control variate.
  SplitTree(const DepthImportance& importance, double& control_variate)
      : importance_(importance), control_variate_(control_variate) {}

  void begin(const PathVertex& start, const Vec3& direction) {
    throughput_ = 1;
    waiting_.clear();
    at_ = {.log_gradient = importance_.importance_and_gradient(start.point).log_gradient};
    if (const auto& control_variate = importance_.control_variate())
      departing_ = control_variate->mode.departing(control_variate->growth(start.point.x),
                                                   control_variate->cosine(direction));
  }
  /// Gradient of log(importance) at the current vertex, which biases free flights.
  const Vec3* log_gradient() const { return &at_.log_gradient; }
  void bias(double factor) { throughput_ *= factor; }

  /// Adds a flight to the control variate. before: weight of the path before the flight, without
  /// the factor for biased sampling.
  void flew(double before, const PathVertex& here, const Flight& flight) {
    const auto& control_variate = importance_.control_variate();
    if (!control_variate) return;
    at_.growth = control_variate->growth(flight.point.x);
    const double cosine = control_variate->cosine(flight.direction);
    at_.arriving = control_variate->mode.arriving(at_.growth, cosine);
    const bool is_out = flight.end == Flight::End::boundary;
    const double there =
        is_out ? control_variate->mode.departing(at_.growth, cosine) : at_.arriving;
    control_variate_ += here.weight * there - before * departing_;
    at_.arriving /= control_variate->albedo;
  }
  void turned(const PathVertex& here, const Vec3& direction) {
    const auto& control_variate = importance_.control_variate();
    if (!control_variate) return;
    departing_ = control_variate->mode.departing(at_.growth, control_variate->cosine(direction));
    control_variate_ += here.weight * (departing_ - at_.arriving);
  }

  template <class Tally>
  bool collide(const PathVertex& here, const Flight& flight, const ScatteringMedium& medium,
               PathVertex& next, RandomStream& random, const TransportCounts& counts,
               Tally& tally) {
    const double albedo = medium.albedo();
    tally.absorbed(here, flight, albedo);
    throughput_ *= flight.weight * albedo;
    const auto [importance, log_gradient] = importance_.importance_and_gradient(next.point);
    at_.log_gradient = log_gradient;
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
    at_ = last.at;
    if (--last.copies == 0) waiting_.pop_back();
    return true;
  }

 private:
  struct Place {
    Vec3 log_gradient;
    /// Values of the control variate's CaseMode; arriving is divided by the albedo.
    double growth = 0, arriving = 0;
  };
  struct Waiting {
    PathVertex vertex;
    Place at;
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
    control_variate_ += (next.weight - before) * at_.arriving;
    tally.reweighed(next.point.part, medium.mu_a > 0, before - next.weight);
    return next.weight > 0;
  }
  void split(double expected, PathVertex& next) {
    constexpr double most_copies = 64;
    const int copies = static_cast<int>(std::min(expected, most_copies));
    next.weight /= copies;
    throughput_ /= copies;
    waiting_.push_back({next, at_, throughput_, copies - 1});
  }

  const DepthImportance& importance_;
  double& control_variate_;
  double throughput_ = 1;
  Place at_ = {};
  double departing_ = 0;
  std::vector<Waiting> waiting_;
};

}  // namespace flatspeckle::grin
