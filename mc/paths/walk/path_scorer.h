#pragma once

#include <cstdint>
#include <vector>

#include "mc/paths/endpoint_factors/space_scattering.h"

namespace flatspeckle::mc {

/// A path of B >= 2 scatterers as the walk found it. The mean of weight f_a conj(f_b) over walks is
/// the covariance, with f = F, or F + R with reversed paths (conventions, C14), whose amplitudes
/// are divided by sqrt(sigma_s).
struct Path {
  Vec2 first;  ///< the first scatterer
  SpaceDirection start;
  Vec2 last;
  SpaceDirection arrival;  ///< at the last scatterer
  double weight = 0;
  bool new_start = false;  ///< the first such path from this first scatterer and start
};

/// Takes the paths that a walk finds.
class PathScorer {
 public:
  virtual ~PathScorer() = default;

  /// A path of one scatterer at x, where the plan samples them.
  virtual void single(Vec2 x, double weight) = 0;
  /// A path of more.
  virtual void multiple(const Path& path) = 0;

  // The rest is for scorers that tally each path's flights and inner scatterings (not those of the
  // first and last scatterer).

  /// Whether step() is called.
  virtual bool has_tally() const { return false; }
  /// A path begins at x, its first scatterer, with a flight along w.
  virtual void begin(Vec2 /*x*/, const SpaceDirection& /*w*/, double /*length*/) {}
  /// It is scattered at x, and flies on along `to`.
  virtual void step(Vec2 /*x*/, const SpaceDirection& /*from*/, const SpaceDirection& /*to*/,
                    double /*length*/) {}
  /// Its tally is kept for the paths that it splits into, then taken up again by each; last: for
  /// the last time. What was kept last is taken up first.
  virtual void keep() {}
  virtual void take_up(bool /*last*/) {}
};

/// A scorer with a tally: a copyable type with
///   flight(x, w, length)
///   scattering(x, from, to)
template <typename Tally>
class TallyScorer : public PathScorer {
 public:
  bool has_tally() const final { return true; }
  void begin(Vec2 x, const SpaceDirection& w, double length) final {
    tally_ = none_;
    tally_.flight(x, w, length);
  }
  void step(Vec2 x, const SpaceDirection& from, const SpaceDirection& to, double length) final {
    tally_.scattering(x, from, to);
    tally_.flight(x, to, length);
  }
  void keep() final { kept_.push_back(tally_); }
  void take_up(bool last) final {
    tally_ = kept_.back();
    if (last) kept_.pop_back();
  }

 protected:
  /// none: what every path starts with.
  explicit TallyScorer(const Tally& none) : none_(none), tally_(none) {}

  const Tally& none() const { return none_; }
  const Tally& tally() const { return tally_; }

 private:
  Tally none_, tally_;
  std::vector<Tally> kept_;
};

}  // namespace flatspeckle::mc
