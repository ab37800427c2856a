#pragma once

#include <algorithm>
#include <limits>
#include <optional>

#include "grin/rays/connections/connection_solver.h"
#include "grin/rays/connections/damped_step.h"
#include "grin/rays/connections/geometric_spreading.h"
#include "grin/render/specular/crossing_walk.h"

namespace flatspeckle::grin {

/// Trials of a specular connection search (shooting method): each starts from a direction and
/// corrects it by damped Gauss-Newton steps through the same interface crossings. An Aim is a start
/// direction with these crossings, a Shot the ray traced for an Aim. A trial that converges is a
/// valid ray; no other check is needed. Template argument Found: SpecularPath or BeamConnection.
/// The derived class has
///   land(aim, shot)          sets the end of a shot's last segment, and the error of the end;
///   map(aim, shot)           transverse displacement of the end per turn of the start direction;
///   moved(aim, shot, step)   the aim after a step;
///   judged(aim, shot)        the result of the trial, for a shot that has arrived;
///   same(found, found)       whether two trials have found the same connection;
/// and optionally begins(aim), which returns whether the aim is valid, and mend(shot, aim), which
/// improves a shot that has not reduced the error by half.
template <class Search, class Found>
class CrossingSearch {
 protected:
  struct Aim {
    Vec3 direction;  ///< unit
    InterfaceCrossings crossings = {};
    double sigma = 0;  ///< ray parameter of the last segment
    int steps = 1;     ///< number of steps in the last segment
  };
  struct Shot {
    bool is_ray = false;  ///< whether a ray with the crossings of the Aim exists
    CrossingWalk::Head head;
    RayState end;
    RayTangent tangent = {};
    PlaneCrossing crossing = {};  ///< crossing with the plane of parallel light
    Vec3 error = Vec3::Zero();    ///< difference between the end and its target
    double miss = 0;              ///< length of the error
  };
  struct Trial {
    TrialOutcome outcome;
    std::optional<Found> found = {};  ///< set if the trial has converged
  };

  /// Holds a reference to the options. close: error below which a shot may count as arrived;
  /// rounding: rounding error of Shot::error.
  CrossingSearch(const Segments& segments, const PathPoint& from, Seek seek,
                 const ConnectionOptions& options, double close, double rounding)
      : segments_(segments),
        walk_(segments_, from, seek),
        from_(from),
        options_(options),
        close_(close),
        rounding_(rounding) {}
  CrossingSearch(const CrossingSearch&) = delete;

  /// Receives approaches of a ray to the target (crossings, sigma, squared error), and sets the aim
  /// to the one with the least squared error.
  struct Closest {
    Aim& aim;
    double least = std::numeric_limits<double>::infinity();

    void operator()(const InterfaceCrossings& met, double sigma, double square) {
      if (!(square < least)) return;
      least = square;
      aim.crossings = met;
      aim.sigma = sigma;
    }
  };
  /// Receives approaches of a ray to the target, and sets the aim to one of them, drawn with a
  /// probability proportional to 1 / (squared error + soft).
  struct Drawn {
    Aim& aim;
    double soft;
    RandomStream& random;
    double total = 0;

    void operator()(const InterfaceCrossings& met, double sigma, double square) {
      const double weight = 1 / (square + soft);
      total += weight;
      if (!(random.uniform() * total <= weight)) return;
      aim.crossings = met;
      aim.sigma = sigma;
    }
  };

  Shot shoot(const Aim& aim, RandomStream& random) const {
    Shot shot;
    const auto head = walk_.follow(aim.direction, aim.crossings, &shot.tangent, random);
    if (!head) return shot;
    shot.is_ray = true;
    shot.head = *head;
    shot.end = head->ray;
    self().land(aim, shot);
    shot.miss = shot.error.norm();
    return shot;
  }

  /// Runs a trial from an aim and counts its outcome in the statistics.
  Trial counted(const Aim& aim, RandomStream& random, ConnectionStatistics& statistics) const {
    const Trial trial = refined(aim, random, statistics);
    statistics.add(trial.outcome);
    return trial;
  }

  /// Counts a trial that does not approach the connection.
  Trial missed(ConnectionStatistics& statistics) const {
    statistics.add(TrialOutcome::no_approach);
    return {TrialOutcome::no_approach};
  }

  /// Estimates K of C26, the reciprocal of the probability that a trial finds the connection `one`,
  /// which a first trial has found. draw(crossings) runs another trial; because a trial keeps the
  /// crossings from which it starts, it may end at once if they are not these.
  template <class Draw>
  double multiplicity(const Found& one, const Draw& draw, RandomStream& random,
                      ConnectionStatistics& statistics) const {
    const auto finds_again = [&] {
      const Trial again = draw(&one.crossings);
      return again.found && self().same(one, *again.found);
    };
    return reciprocal_probability(finds_again, options_.roulette_after, random, statistics);
  }

  Segments segments_;
  CrossingWalk walk_;
  PathPoint from_;
  const ConnectionOptions& options_;
  double close_, rounding_;

 private:
  const Search& self() const { return static_cast<const Search&>(*this); }

  Trial refined(Aim aim, RandomStream& random, ConnectionStatistics& statistics) const {
    if constexpr (requires { self().begins(aim); })
      if (!self().begins(aim)) return {TrialOutcome::no_approach};
    Shot shot = shoot(aim, random);
    if (!shot.is_ray) return {TrialOutcome::no_approach};
    DampedStep damped;
    for (int i = 0; i < options_.max_iterations && !damped.stuck(); ++i) {
      if (arrived(aim, shot)) return self().judged(aim, shot);
      Aim next = self().moved(aim, shot, damped);
      Shot tried = shoot(next, random);
      ++statistics.iterations;
      if constexpr (requires { self().mend(tried, next); })
        if (tried.is_ray && tried.miss >= shot.miss / 2) self().mend(tried, next);
      if (tried.is_ray && tried.miss < shot.miss) {
        damped.succeeded(tried.miss / shot.miss);
        aim = next;
        shot = tried;
      } else {
        damped.failed();
      }
    }
    return {TrialOutcome::not_converged};
  }

  /// Whether the end of a shot is accurate enough to determine the start direction to options.same
  /// / 10.
  bool arrived(const Aim& aim, const Shot& shot) const {
    return shot.miss <= close_ &&
           shot.miss <=
               std::max(rounding_, options_.same / 10 * widths(self().map(aim, shot)).narrow);
  }
};

}  // namespace flatspeckle::grin
