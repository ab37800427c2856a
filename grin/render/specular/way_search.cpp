#include <algorithm>
#include <cmath>
#include <optional>

#include "grin/rays/connections/connection_solver.h"
#include "grin/render/specular/passage_walk.h"
#include "grin/render/specular/way.h"

namespace flatspeckle::grin {

namespace {

/// A way and its weight (C26): f(way) multiplicity is unbiased for the sum of f over all ways.
struct WayEstimate {
  std::optional<Way> way;
  double multiplicity = 0;
};

/// Ways between two points that are refracted or reflected once or more (Fermat's principle). One
/// trial (conventions, C26) draws a start direction, follows its ray, which at surfaces is
/// refracted or reflected at random, picks one of the points where the ray comes closest to the
/// end, and mends the direction and the length of the last leg from there by damped Gauss-Newton
/// steps, through the same passages. What converges is a ray of light: no other check is needed.
class WaySearch {
 public:
  /// Refers to the legs. options.start: how the trials of a point in the body begin.
  WaySearch(const Legs& legs, const PathPoint& from, const PathPoint& to,
            const ConnectionOptions& options)
      : legs_(legs),
        walk_(legs, from, Seek::strongest),
        from_(from),
        to_(to),
        options_(options),
        n_from_(legs.index(from)),
        gap_((to.x - from.x).norm()),
        rounding_(1e-14 * std::max(from.x.norm(), to.x.norm())) {}

  /// One random way with its multiplicity. A trial starts along the chord with a chance that
  /// depends on the two points alone; where that leads is computed once.
  WayEstimate find(RandomStream& random, ConnectionStatistics& statistics) const {
    if (!(gap_ > rounding_)) return {};
    const Trial chord = along_chord(random, statistics);
    const double chance = is_found(chord) ? 0.6 : 0;
    const auto draw = [&] {
      return random.uniform() < chance ? chord : at_random(random, statistics);
    };
    ++statistics.pairs;
    const Trial first = draw();
    if (!is_found(first)) return {};
    ++statistics.found;
    const auto refinds = [&] {
      const Trial again = draw();
      return is_found(again) && same(first.way, again.way);
    };
    return {first.way, trials_to_refind(refinds, options_.roulette_after, random, statistics)};
  }

  /// As PassageWalk.
  template <class Use>
  void for_each_leg(const Way& way, RandomStream& random, const Use& use) const {
    walk_.for_each_leg(way.start_direction, way.passages, way.arc_length, random, use);
  }

 private:
  static constexpr double near = 1e-2;        // of the end, in units of the gap
  static constexpr double on_caustic = 1e-6;  // narrower than this against its length

  struct Aim {
    Vec3 direction;  // unit
    Passages passages = {};
    double sigma = 0;  // of the last leg
    int steps = 1;     // in it
  };
  struct Shot {
    bool is_ray = false;  // goes through the passages
    Part part = around;
    RayState last = {}, end = {};  // where the last leg begins and ends
    RayTangent tangent = {};
    double chance = 1;
    int hollows = 0;
    Vec3 error = {};  // of the end, and its length
    double miss = 0;
  };
  struct Trial {
    TrialOutcome outcome;
    Way way = {};
  };

  static bool is_found(const Trial& trial) { return trial.outcome == TrialOutcome::converged; }
  bool same(const Way& a, const Way& b) const {
    const double length = std::max(a.arc_length, b.arc_length);
    return a.passages == b.passages && a.orientation == b.orientation &&
           (a.start_direction - b.start_direction).norm() <= options_.same &&
           std::abs(a.arc_length - b.arc_length) <= options_.same * length;
  }

  /// offer(passages, sigma of the last leg, squared distance there) where a ray comes closest.
  template <class Offer>
  auto approaches(const Offer& offer) const {
    return [this, offer](const Passages& met, Part part, const RayState& ray) {
      if (met.count == 0 || !legs_.are_alike(part, to_.part)) return;
      legs_.approach(part, ray, to_.x,
                     [&](double sigma, double square) { offer(met, sigma, square); });
    };
  }
  /// Rays are refracted wherever they can be; the closest approach.
  Trial along_chord(RandomStream& random, ConnectionStatistics& statistics) const {
    Aim aim{(to_.x - from_.x) / gap_};
    double closest = std::numeric_limits<double>::infinity();
    walk_.refracted(aim.direction, random,
                    approaches([&](const Passages& met, double sigma, double square) {
                      if (!(square < closest)) return;
                      closest = square;
                      aim.passages = met;
                      aim.sigma = sigma;
                    }));
    return counted(refined(aim, random, statistics), statistics);
  }

  Trial at_random(RandomStream& random, ConnectionStatistics& statistics) const {
    Aim aim{walk_.start_direction((to_.x - from_.x) / gap_, options_.start, random)};
    double total = 0;
    walk_.at_random(aim.direction, random,
                    approaches([&](const Passages& met, double sigma, double square) {
                      const double weight = 1 / (square + 1e-4 * gap_ * gap_);
                      total += weight;
                      if (random.uniform() * total > weight) return;
                      aim.passages = met;
                      aim.sigma = sigma;
                    }));
    return counted(refined(aim, random, statistics), statistics);
  }
  static Trial counted(const Trial& trial, ConnectionStatistics& statistics) {
    ++statistics.outcomes[static_cast<int>(trial.outcome)];
    return trial;
  }
  Shot shoot(const Aim& aim, RandomStream& random, ConnectionStatistics& statistics) const {
    Shot shot;
    const auto head = walk_.follow(aim.direction, aim.passages, &shot.tangent, random);
    if (!head) return shot;
    shot.is_ray = true;
    shot.part = head->part;
    shot.chance = head->chance;
    shot.hollows = head->hollows;
    shot.last = shot.end = head->ray;
    legs_.advance(shot.part, aim.sigma, aim.steps, shot.end, &shot.tangent);
    statistics.tangent_steps += aim.steps;
    settle(shot);
    return shot;
  }
  void settle(Shot& shot) const {
    shot.error = shot.end.x - to_.x;
    shot.miss = shot.error.norm();
  }

  Trial refined(Aim aim, RandomStream& random, ConnectionStatistics& statistics) const {
    if (!(aim.sigma > 0)) return {TrialOutcome::no_approach};
    aim.steps = legs_.steps(to_.part, aim.sigma);
    Shot shot = shoot(aim, random, statistics);
    if (!shot.is_ray) return {TrialOutcome::no_approach};
    DampedStep damped;
    for (int i = 0; i < options_.max_iterations && !damped.stuck(); ++i) {
      if (arrived(aim, shot)) return judged(aim, shot);
      Aim next = moved(aim, shot, damped);
      Shot tried = shoot(next, random, statistics);
      ++statistics.iterations;
      if (tried.is_ray && tried.miss >= shot.miss / 2) next.sigma += draw_near(tried, next.sigma);
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

  Widths end_widths(const Aim& aim, const Shot& shot) const {
    return widths(transverse_map(shot.tangent, n_from_, frame_across(aim.direction),
                                 frame_across(shot.end.v)));
  }
  /// The end is where it should be, and so well that the direction is known.
  bool arrived(const Aim& aim, const Shot& shot) const {
    const double close = std::max(rounding_, options_.tolerance * gap_);
    return shot.miss <= close &&
           shot.miss <= std::max(rounding_, options_.same / 10 * end_widths(aim, shot).narrow);
  }

  /// Moves the end along its ray to where it comes closest. Returns the change of sigma.
  double draw_near(Shot& shot, double sigma) const {
    const double wanted = -shot.error.dot(shot.end.v) / shot.end.v.squaredNorm();
    const double change = std::clamp(wanted, -sigma / 2, sigma / 2);
    legs_.advance(shot.part, change, 1, shot.end, &shot.tangent);
    settle(shot);
    return change;
  }

  Aim moved(const Aim& aim, const Shot& shot, DampedStep& damped) const {
    const CurveStart start =
        stepped({aim.direction, aim.sigma}, n_from_, shot.end, shot.tangent, shot.error, damped);
    Aim next = aim;
    next.direction = start.direction;
    next.sigma = start.sigma;
    if (shot.miss > near * gap_) next.steps = legs_.steps(to_.part, next.sigma);
    return next;
  }

  Trial judged(const Aim& aim, const Shot& shot) const {
    if (!legs_.are_alike(shot.part, to_.part) || !legs_.stays(shot.part, shot.last, aim.sigma))
      return {TrialOutcome::left_region};
    if (shot.end.arc_length > options_.max_length) return {TrialOutcome::too_long};
    if (end_widths(aim, shot).narrow < on_caustic * shot.end.arc_length)
      return {TrialOutcome::degenerate};
    const double spreading = signed_spreading(shot.tangent, n_from_, aim.direction, shot.end.v);
    return {TrialOutcome::converged,
            {aim.direction, shot.end.v.normalized(), std::abs(spreading), spreading < 0 ? -1 : 1,
             shot.end.arc_length, shot.end.optical_path, aim.passages, shot.chance, shot.hollows,
             aim.sigma}};
  }

  const Legs& legs_;
  PassageWalk walk_;
  PathPoint from_, to_;
  const ConnectionOptions& options_;
  double n_from_, gap_;
  double rounding_;  ///< of the end points' coordinates
};

}  // namespace

/// Backwards if that leads into the denser part, where no ray is lost by total reflection.
std::optional<Join> Space::join_through(const PathPoint& p, const PathPoint& q,
                                        RandomStream& random,
                                        ConnectionStatistics& statistics) const {
  if (!joins_through()) return std::nullopt;
  const Legs legs(*this);
  const double n_p = legs.index(p), n_q = legs.index(q);
  const bool backwards = n_q < n_p;
  const WaySearch search(legs, backwards ? q : p, backwards ? p : q, setup_->search);
  const auto [way, multiplicity] = search.find(random, statistics);
  if (!way) return std::nullopt;
  Join join{.start_direction = way->start_direction,
            .end_direction = way->end_direction,
            .spreading = way->spreading,
            .optical_path = way->optical_path,
            .optical_depth = -std::log(way->chance),
            .transmittance = way->chance,
            .multiplicity = multiplicity,
            .passages = way->passages,
            .fresnel = way->chance,
            .hollows = way->hollows};
  if (backwards) {  // n_p^2 / |J_pq| = n_q^2 / |J_qp|
    join.start_direction = -way->end_direction;
    join.end_direction = -way->start_direction;
    join.spreading *= n_p / n_q * (n_p / n_q);
  }
  search.for_each_leg(*way, random, [&](Part part, const RayState& start, double length) {
    join.optical_depth += legs.reference(part) * length;
    join.transmittance *= legs.transmitted(part, start, length, random);
  });
  return join;
}

}  // namespace flatspeckle::grin
