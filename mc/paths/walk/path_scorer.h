#pragma once

#include <cstdint>
#include <vector>

#include "mc/paths/endpoint_factors/faced_endpoints.h"
#include "mc/paths/endpoint_factors/space_scattering.h"

namespace flatspeckle::mc {

/// A sampled light path of B >= 2 scatterers. The covariance of two channels a and b is the mean
/// over walks of the sum of weight f_a conj(f_b) over the paths of a walk. The field f of a channel
/// is F, or F + R if reversed paths are included (conventions, C14), with all amplitudes divided by
/// sqrt(sigma_s).
struct Path {
  Vec first;  ///< the first scatterer
  Vec start;  ///< direction in which the path leaves the first scatterer
  Vec last;
  Vec arrival;  ///< direction in which the path reaches the last scatterer
  double weight = 0;
  bool new_start = false;  ///< true for the first path with these values of `first` and `start`
  FaceWaves waves{};
};

/// Receives the paths that a walk samples.
class PathScorer {
 public:
  virtual ~PathScorer() = default;

  /// Scores a path of one scatterer at x. Called only if the plan samples such paths
  /// (Plan::sampled_single).
  virtual void single(Vec x, double weight, FaceWaves waves) = 0;
  /// Scores a path of two or more scatterers.
  virtual void multiple(const Path& path) = 0;

  // The members below are for scorers with a tally: sums over the free flights and scatterings of
  // each path. The scatterings at the first and the last scatterer are not tallied.

  /// Whether the scorer has a tally. Walks call step() only for scorers that have one.
  virtual bool has_tally() const { return false; }
  /// Begins the tally of a path with the flight from its first scatterer x along w.
  virtual void begin(Vec /*x*/, Vec /*w*/, double /*length*/) {}
  /// Adds the scattering at x from direction `from` to direction `to`, and the flight along `to`
  /// that follows.
  virtual void step(Vec /*x*/, Vec /*from*/, Vec /*to*/, double /*length*/) {}
  /// Saves the tally for the paths into which this path splits. Each of these paths restores the
  /// saved tally by take_up(), the last one with last = true. Saved tallies form a stack.
  virtual void keep() {}
  virtual void take_up(bool /*last*/) {}
};

/// Scorer that sums over the free flights and scatterings of each path in a Tally, a copyable type
/// with the members
///   flight(x, w, length)
///   scattering(x, from, to)
template <typename Tally>
class TallyScorer : public PathScorer {
 public:
  bool has_tally() const final { return true; }
  void begin(Vec x, Vec w, double length) final {
    tally_ = none_;
    tally_.flight(x, w, length);
  }
  void step(Vec x, Vec from, Vec to, double length) final {
    tally_.scattering(x, from, to);
    tally_.flight(x, to, length);
  }
  void keep() final { kept_.push_back(tally_); }
  void take_up(bool last) final {
    tally_ = kept_.back();
    if (last) kept_.pop_back();
  }

 protected:
  /// none: the tally with which every path starts.
  explicit TallyScorer(const Tally& none) : none_(none), tally_(none) {}

  const Tally& none() const { return none_; }
  const Tally& tally() const { return tally_; }

 private:
  Tally none_, tally_;
  std::vector<Tally> kept_;
};

}  // namespace flatspeckle::mc
