#pragma once

#include <vector>

#include "grin/media/scattering/scattering_medium.h"
#include "grin/render/transport/depth_importance.h"
#include "grin/render/transport/path_vertex.h"
#include "grin/render/transport/transport_counts.h"

namespace flatspeckle::grin {

// What happens to a path's weight at collisions: `here` is where the flight came from, `next`, of
// the weight before the collision, where it ended. collide() returns whether a path goes on from
// `next`.

/// Of the throughput: absorption takes a share of a path's weight until that would fall below this,
/// and from then on all of it or nothing, by chance. Each path keeps its power to the last.
inline constexpr double capture_level = 0.25;

/// A path that stays one.
class LonePath {
 public:
  static constexpr bool is_split() { return false; }
  void begin(const PathVertex&, const Vec3&) { throughput_ = 1; }
  const Vec3* rise() const { return nullptr; }
  void stretched(double) {}
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

/// A path that is split on its way to where light is worth more, and plays roulette on the way back
/// (weight windows): all that comes of one beginning. Weights of multiple importance sampling do
/// not see it: they still sum to 1 for each path.
class LightFamily {
 public:
  static constexpr bool is_split() { return true; }
  /// Refers to it, and adds up its drift.
  LightFamily(const DepthImportance& importance, double& drift)
      : importance_(importance), drift_(drift) {}

  void begin(const PathVertex& start, const Vec3& direction) {
    throughput_ = 1;
    waiting_.clear();
    at_ = {.rise = importance_.outlook(start.point).rise};
    if (const auto& drift = importance_.drift())
      departing_ = drift->mode.departing(drift->growth(start.point.x), drift->cosine(direction));
  }
  /// Of the worth where the path is: flights are stretched along it.
  const Vec3* rise() const { return &at_.rise; }
  void stretched(double factor) { throughput_ *= factor; }

  /// Of the weight `before` that it was stretched.
  void flew(double before, const PathVertex& here, const Flight& flight) {
    const auto& drift = importance_.drift();
    if (!drift) return;
    at_.growth = drift->growth(flight.point.x);
    const double cosine = drift->cosine(flight.direction);
    at_.arriving = drift->mode.arriving(at_.growth, cosine);
    const bool is_out = flight.end == Flight::End::boundary;
    const double there = is_out ? drift->mode.departing(at_.growth, cosine) : at_.arriving;
    drift_ += here.weight * there - before * departing_;
    at_.arriving /= drift->albedo;
  }
  void turned(const PathVertex& here, const Vec3& direction) {
    const auto& drift = importance_.drift();
    if (!drift) return;
    departing_ = drift->mode.departing(at_.growth, drift->cosine(direction));
    drift_ += here.weight * (departing_ - at_.arriving);
  }

  template <class Tally>
  bool collide(const PathVertex& here, const Flight& flight, const ScatteringMedium& medium,
               PathVertex& next, RandomStream& random, const TransportCounts& counts,
               Tally& tally) {
    const double albedo = medium.albedo();
    tally.absorbed(here, flight, albedo);
    throughput_ *= flight.weight * albedo;
    const auto [worth, rise] = importance_.outlook(next.point);
    at_.rise = rise;
    const double expected = throughput_ * worth;
    if (expected < 0.5) return survives(expected, medium, next, random, tally);
    if (expected > 2 && counts.flights < last_splitting) split(expected, next);
    return true;
  }

  /// Another that waits.
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
    Vec3 rise;
    double growth = 0, arriving = 0;  ///< of the slow mode; the latter after the albedo
  };
  struct Waiting {
    PathVertex vertex;
    Place at;
    double throughput;
    int copies;
  };
  /// Of a batch: where depth promises more than it gives, families would grow for ever. As it
  /// depends on the past alone it changes no mean.
  static constexpr std::uint64_t last_splitting = 4'000'000;

  template <class Tally>
  bool survives(double chance, const ScatteringMedium& medium, PathVertex& next,
                RandomStream& random, Tally& tally) {
    const double before = next.weight;
    next.weight = random.uniform() < chance ? before / chance : 0;
    throughput_ /= chance;
    drift_ += (next.weight - before) * at_.arriving;
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
  double& drift_;
  double throughput_ = 1;
  Place at_ = {};
  double departing_ = 0;
  std::vector<Waiting> waiting_;
};

}  // namespace flatspeckle::grin
