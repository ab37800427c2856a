#pragma once

#include <algorithm>
#include <limits>
#include <optional>

#include "grin/rays/connections/connection_solver.h"
#include "grin/rays/connections/damped_step.h"
#include "grin/rays/connections/geometric_spreading.h"
#include "grin/render/specular/passage_walk.h"

namespace flatspeckle::grin {

/// Trials in search of a way through bodies, which start from a direction and mend it by damped
/// Gauss-Newton steps through the same passages. What converges is a ray of light: no other check
/// is needed. Of a search:
///   land(aim, shot)          sets the end of a shot's last leg, and its error;
///   map(aim, shot)           how the end moves across as the start direction turns;
///   moved(aim, shot, step)   the aim after a step;
///   judged(aim, shot)        the trial that has arrived;
///   same(way, way)           whether two trials have found the same;
/// and maybe begins(aim), whether there is one, and mend(shot, aim) of a shot that went wide.
template <class Search, class Way>
class PassageSearch {
 protected:
  struct Aim {
    Vec3 direction;  ///< unit
    Passages passages = {};
    double sigma = 0;  ///< of the last leg
    int steps = 1;     ///< in it
  };
  struct Shot {
    bool is_ray = false;  ///< goes through the passages
    PassageWalk::Head head;
    RayState end;
    RayTangent tangent = {};
    PlaneCrossing crossing = {};  ///< of parallel light
    Vec3 error = Vec3::Zero();    ///< of the end, and its length
    double miss = 0;
  };
  struct Trial {
    TrialOutcome outcome;
    std::optional<Way> way = {};  ///< if converged
  };

  /// The options are referred to. close: an error that is none but for its derivative; rounding: of
  /// errors.
  PassageSearch(const Legs& legs, const PathPoint& from, Seek seek,
                const ConnectionOptions& options, double close, double rounding)
      : legs_(legs),
        walk_(legs_, from, seek),
        from_(from),
        options_(options),
        close_(close),
        rounding_(rounding) {}
  PassageSearch(const PassageSearch&) = delete;

  /// Of approaches (passages, sigma, square) aims at that of the least square.
  struct Closest {
    Aim& aim;
    double least = std::numeric_limits<double>::infinity();

    void operator()(const Passages& met, double sigma, double square) {
      if (!(square < least)) return;
      least = square;
      aim.passages = met;
      aim.sigma = sigma;
    }
  };
  /// Or at one that is drawn with weights 1 / (square + soft).
  struct Drawn {
    Aim& aim;
    double soft;
    RandomStream& random;
    double total = 0;

    void operator()(const Passages& met, double sigma, double square) {
      const double weight = 1 / (square + soft);
      total += weight;
      if (!(random.uniform() * total <= weight)) return;
      aim.passages = met;
      aim.sigma = sigma;
    }
  };

  Shot shoot(const Aim& aim, RandomStream& random) const {
    Shot shot;
    const auto head = walk_.follow(aim.direction, aim.passages, &shot.tangent, random);
    if (!head) return shot;
    shot.is_ray = true;
    shot.head = *head;
    shot.end = head->ray;
    self().land(aim, shot);
    shot.miss = shot.error.norm();
    return shot;
  }

  /// The trial from an aim on.
  Trial counted(const Aim& aim, RandomStream& random, ConnectionStatistics& statistics) const {
    const Trial trial = refined(aim, random, statistics);
    statistics.add(trial.outcome);
    return trial;
  }

  /// K of C26 of the way that a first trial has found; draw() makes another.
  template <class Draw>
  double multiplicity(const Way& way, const Draw& draw, RandomStream& random,
                      ConnectionStatistics& statistics) const {
    const auto refinds = [&] {
      const Trial again = draw();
      return again.way && self().same(way, *again.way);
    };
    return trials_to_refind(refinds, options_.roulette_after, random, statistics);
  }

  Legs legs_;
  PassageWalk walk_;
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

  /// The end is where it should be, and so well that the start is known.
  bool arrived(const Aim& aim, const Shot& shot) const {
    return shot.miss <= close_ &&
           shot.miss <=
               std::max(rounding_, options_.same / 10 * widths(self().map(aim, shot)).narrow);
  }
};

}  // namespace flatspeckle::grin
