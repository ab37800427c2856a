#include <algorithm>
#include <cmath>
#include <optional>

#include "grin/render/specular/passage_search.h"

namespace flatspeckle::grin {

namespace {

/// A way between two points that is refracted or reflected.
struct Way {
  Vec3 start_direction, end_direction;  ///< unit tangents along the way
  double spreading;                     ///< |J| from start to end
  int orientation;                      ///< sign of the determinant in J
  double arc_length, optical_path;
  Passages passages;
  double chance;  ///< Fresnel's, that light takes these passages
  int hollows;    ///< of these, at surfaces that are not convex
};

/// A way and its weight (C26): f(way) multiplicity is unbiased for the sum of f over all ways.
struct WayEstimate {
  std::optional<Way> way;
  double multiplicity = 0;
};

/// Ways between two points that are refracted or reflected once or more (Fermat's principle). One
/// trial (conventions, C26) draws a start direction, follows its ray, which at surfaces is
/// refracted or reflected at random, picks one of the points where the ray comes closest to the
/// end, and mends the direction and the length of the last leg from there.
class WaySearch : PassageSearch<WaySearch, Way> {
 public:
  /// options.start: how the trials of a point in the body begin.
  WaySearch(const Legs& legs, const PathPoint& from, const PathPoint& to,
            const ConnectionOptions& options)
      : WaySearch(legs, from, to, options, (to.x - from.x).norm(),
                  1e-14 * std::max(from.x.norm(), to.x.norm())) {}

  /// One random way with its multiplicity. A trial starts along the chord with a chance that
  /// depends on the two points alone; where that leads is computed once.
  WayEstimate find(RandomStream& random, ConnectionStatistics& statistics) const {
    if (!(gap_ > rounding_)) return {};
    const Trial chord = along_chord(random, statistics);
    const double chance = chord.way ? 0.6 : 0;
    const auto draw = [&] {
      return random.uniform() < chance ? chord : at_random(random, statistics);
    };
    ++statistics.pairs;
    const Trial first = draw();
    if (!first.way) return {};
    ++statistics.found;
    return {first.way, multiplicity(*first.way, draw, random, statistics)};
  }

  /// As PassageWalk.
  template <class Use>
  void for_each_leg(const Way& way, RandomStream& random, const Use& use) const {
    walk_.for_each_leg(way.start_direction, way.passages, way.arc_length, random, use);
  }

 private:
  friend PassageSearch;
  static constexpr double near = 1e-2;        // of the end, in units of the gap
  static constexpr double on_caustic = 1e-6;  // narrower than this against its length

  WaySearch(const Legs& legs, const PathPoint& from, const PathPoint& to,
            const ConnectionOptions& options, double gap, double rounding)
      : PassageSearch(legs, from, Seek::strongest, options,
                      std::max(rounding, options.tolerance * gap), rounding),
        to_(to),
        n_from_(legs.index(from)),
        gap_(gap) {}

  bool same(const Way& a, const Way& b) const {
    const double length = std::max(a.arc_length, b.arc_length);
    return a.passages == b.passages && a.orientation == b.orientation &&
           (a.start_direction - b.start_direction).norm() <= options_.same &&
           std::abs(a.arc_length - b.arc_length) <= options_.same * length;
  }

  /// offer(passages, sigma of the last leg, squared distance there) where a ray comes closest.
  template <class Offer>
  auto approaches(Offer& offer) const {
    return [this, &offer](const Passages& met, Part part, const RayState& ray) {
      if (met.count == 0 || !legs_.are_alike(part, to_.part)) return;
      legs_.approach(part, ray, to_.x,
                     [&](double sigma, double square) { offer(met, sigma, square); });
    };
  }
  /// Rays are refracted wherever they can be; the closest approach.
  Trial along_chord(RandomStream& random, ConnectionStatistics& statistics) const {
    Aim aim{(to_.x - from_.x) / gap_};
    Closest closest{aim};
    walk_.refracted(aim.direction, random, approaches(closest));
    return counted(aim, random, statistics);
  }
  Trial at_random(RandomStream& random, ConnectionStatistics& statistics) const {
    Aim aim{walk_.start_direction((to_.x - from_.x) / gap_, options_.start, random)};
    Drawn drawn{aim, 1e-4 * gap_ * gap_, random};
    walk_.at_random(aim.direction, random, approaches(drawn));
    return counted(aim, random, statistics);
  }

  bool begins(Aim& aim) const {
    if (!(aim.sigma > 0)) return false;
    aim.steps = legs_.steps(to_.part, aim.sigma);
    return true;
  }
  void land(const Aim& aim, Shot& shot) const {
    legs_.advance(shot.head.part, aim.sigma, aim.steps, shot.end, &shot.tangent);
    shot.error = shot.end.x - to_.x;
  }
  Mat2 map(const Aim& aim, const Shot& shot) const {
    return transverse_map(shot.tangent, n_from_, frame_across(aim.direction),
                          frame_across(shot.end.v));
  }
  /// Moves the end along its ray to where it comes closest.
  void mend(Shot& shot, Aim& aim) const {
    const double wanted = -shot.error.dot(shot.end.v) / shot.end.v.squaredNorm();
    const double change = std::clamp(wanted, -aim.sigma / 2, aim.sigma / 2);
    legs_.advance(shot.head.part, change, 1, shot.end, &shot.tangent);
    shot.error = shot.end.x - to_.x;
    shot.miss = shot.error.norm();
    aim.sigma += change;
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
    const PassageWalk::Head& head = shot.head;
    if (!legs_.are_alike(head.part, to_.part) || !legs_.stays(head.part, head.ray, aim.sigma))
      return {TrialOutcome::left_region};
    if (shot.end.arc_length > options_.max_length) return {TrialOutcome::too_long};
    const Mat2 map = this->map(aim, shot);
    if (widths(map).narrow < on_caustic * shot.end.arc_length) return {TrialOutcome::degenerate};
    const double spreading = map.determinant();
    return {
        TrialOutcome::converged,
        Way{aim.direction, shot.end.v.normalized(), std::abs(spreading), spreading < 0 ? -1 : 1,
            shot.end.arc_length, shot.end.optical_path, aim.passages, head.chance, head.hollows}};
  }

  PathPoint to_;
  double n_from_, gap_;
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
