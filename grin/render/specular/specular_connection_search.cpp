#include <algorithm>
#include <cmath>
#include <optional>

#include "grin/render/specular/crossing_search.h"

namespace flatspeckle::grin {

namespace {

/// A path between two points with refractions or reflections.
struct SpecularPath {
  Vec3 start_direction, end_direction;  ///< unit tangents along the path
  double spreading;                     ///< |J| from start to end (C25)
  int orientation;                      ///< sign of the determinant whose magnitude is |J|
  double arc_length, optical_path;
  InterfaceCrossings crossings;
  double probability;     ///< Fresnel probability of these crossings
  int concave_crossings;  ///< number of crossings at surfaces with concave parts
};

/// A path and its weight (C26): f(path) times multiplicity is an unbiased estimate of the sum of f
/// over all paths.
struct SpecularConnectionEstimate {
  std::optional<SpecularPath> path;
  double multiplicity = 0;
};

/// Search for paths between two points with one or more refractions or reflections (Fermat's
/// principle). One trial (conventions, C26) draws a start direction and follows its ray, which is
/// refracted or reflected at random at surfaces. It selects one of the points where the ray comes
/// closest to the end, and from there corrects the direction and the length of the last segment.
class SpecularConnectionSearch : CrossingSearch<SpecularConnectionSearch, SpecularPath> {
 public:
  /// options.start: distribution of start directions of trials from a point in a body.
  SpecularConnectionSearch(const Segments& segments, const PathPoint& from, const PathPoint& to,
                           const ConnectionOptions& options)
      : SpecularConnectionSearch(segments, from, to, options, (to.x - from.x).norm(),
                                 1e-14 * std::max(from.x.norm(), to.x.norm())) {}

  /// Returns one random path with its multiplicity. With a probability that depends only on the two
  /// points, it is found by the trial that starts along the chord. That trial always has the same
  /// result, which is therefore computed once.
  SpecularConnectionEstimate find(RandomStream& random, ConnectionStatistics& statistics) const {
    if (!(gap_ > rounding_)) return {};
    const Trial chord = along_chord(random, statistics);
    const double probability = chord.found ? 0.6 : 0;
    const auto draw = [&](const InterfaceCrossings* wanted) {
      return random.uniform() < probability ? chord : at_random(random, statistics, wanted);
    };
    ++statistics.pairs;
    const Trial first = draw(nullptr);
    if (!first.found) return {};
    ++statistics.found;
    return {first.found, multiplicity(*first.found, draw, random, statistics)};
  }

  /// Calls CrossingWalk::for_each_segment() for a path that was found.
  template <class Use>
  void for_each_segment(const SpecularPath& path, RandomStream& random, const Use& use) const {
    walk_.for_each_segment(path.start_direction, path.crossings, path.arc_length, random, use);
  }

 private:
  friend CrossingSearch;
  // distance of a shot's end from the target, in units of gap_, below which the number of steps of
  // the last segment stays fixed
  static constexpr double near = 1e-2;
  // displacement of the end per turn of the start direction, divided by the arc length, below which
  // a path counts as on a caustic
  static constexpr double on_caustic = 1e-6;

  SpecularConnectionSearch(const Segments& segments, const PathPoint& from, const PathPoint& to,
                           const ConnectionOptions& options, double gap, double rounding)
      : CrossingSearch(segments, from, Seek::strongest, options,
                       std::max(rounding, options.tolerance * gap), rounding),
        to_(to),
        n_from_(segments.index(from)),
        gap_(gap) {}

  bool same(const SpecularPath& a, const SpecularPath& b) const {
    const double length = std::max(a.arc_length, b.arc_length);
    return a.crossings == b.crossings && a.orientation == b.orientation &&
           (a.start_direction - b.start_direction).norm() <= options_.same &&
           std::abs(a.arc_length - b.arc_length) <= options_.same * length;
  }

  /// Returns a function for CrossingWalk that calls offer(crossings, sigma of the last segment,
  /// squared distance) where the ray comes closest to the end point.
  template <class Offer>
  auto approaches(Offer& offer) const {
    return [this, &offer](const InterfaceCrossings& met, Part part, const RayState& ray) {
      if (met.count == 0 || !segments_.are_alike(part, to_.part)) return;
      segments_.approach(part, ray, to_.x,
                         [&](double sigma, double square) { offer(met, sigma, square); });
    };
  }
  /// Runs the trial that starts along the chord. It follows the ray that is refracted wherever
  /// possible, and begins at the closest approach of this ray to the end point.
  Trial along_chord(RandomStream& random, ConnectionStatistics& statistics) const {
    Aim aim{(to_.x - from_.x) / gap_};
    Closest closest{aim};
    walk_.refracted(aim.direction, random, approaches(closest));
    return counted(aim, random, statistics);
  }
  /// wanted: the only crossings of interest, or null; see multiplicity().
  Trial at_random(RandomStream& random, ConnectionStatistics& statistics,
                  const InterfaceCrossings* wanted) const {
    Aim aim{walk_.start_direction((to_.x - from_.x) / gap_, options_.start, random)};
    Drawn drawn{aim, 1e-4 * gap_ * gap_, random};
    walk_.at_random(aim.direction, random, approaches(drawn));
    if (wanted && aim.crossings != *wanted) return missed(statistics);
    return counted(aim, random, statistics);
  }

  bool begins(Aim& aim) const {
    if (!(aim.sigma > 0)) return false;
    aim.steps = segments_.steps(to_.part, aim.sigma);
    return true;
  }
  void land(const Aim& aim, Shot& shot) const {
    segments_.advance(shot.head.part, aim.sigma, aim.steps, shot.end, &shot.tangent);
    shot.error = shot.end.x - to_.x;
  }
  Mat2 map(const Aim& aim, const Shot& shot) const {
    return transverse_map(shot.tangent, n_from_, frame_across(aim.direction),
                          frame_across(shot.end.v));
  }
  /// Moves the end of a shot along its ray to the closest approach to the end point.
  void mend(Shot& shot, Aim& aim) const {
    const double wanted = -shot.error.dot(shot.end.v) / shot.end.v.squaredNorm();
    const double change = std::clamp(wanted, -aim.sigma / 2, aim.sigma / 2);
    segments_.advance(shot.head.part, change, 1, shot.end, &shot.tangent);
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
    if (shot.miss > near * gap_) next.steps = segments_.steps(to_.part, next.sigma);
    return next;
  }

  Trial judged(const Aim& aim, const Shot& shot) const {
    const CrossingWalk::Head& head = shot.head;
    if (!segments_.are_alike(head.part, to_.part) ||
        !segments_.stays(head.part, head.ray, aim.sigma))
      return {TrialOutcome::left_region};
    if (shot.end.arc_length > options_.max_length) return {TrialOutcome::too_long};
    const Mat2 map = this->map(aim, shot);
    if (widths(map).narrow < on_caustic * shot.end.arc_length) return {TrialOutcome::degenerate};
    const double spreading = map.determinant();
    return {TrialOutcome::converged,
            SpecularPath{aim.direction, shot.end.v.normalized(), std::abs(spreading),
                         spreading < 0 ? -1 : 1, shot.end.arc_length, shot.end.optical_path,
                         aim.crossings, head.probability, head.concave_crossings}};
  }

  PathPoint to_;
  double n_from_, gap_;
};

}  // namespace

/// The search starts at the point with the lower index, since light that enters a part of higher
/// index is not totally reflected.
std::optional<TestConnection> Space::connect_through(const PathPoint& p, const PathPoint& q,
                                                     RandomStream& random,
                                                     ConnectionStatistics& statistics) const {
  if (!connects_through()) return std::nullopt;
  const Segments segments(*this);
  const double n_p = segments.index(p), n_q = segments.index(q);
  const bool backwards = n_q < n_p;
  const SpecularConnectionSearch search(segments, backwards ? q : p, backwards ? p : q,
                                        setup_->search);
  const auto [path, multiplicity] = search.find(random, statistics);
  if (!path) return std::nullopt;
  TestConnection connection{.start_direction = path->start_direction,
                            .end_direction = path->end_direction,
                            .spreading = path->spreading,
                            .optical_path = path->optical_path,
                            .optical_depth = -std::log(path->probability),
                            .transmittance = path->probability,
                            .multiplicity = multiplicity,
                            .crossings = path->crossings,
                            .fresnel = path->probability,
                            .concave_crossings = path->concave_crossings};
  if (backwards) {  // n_p^2 / |J_pq| = n_q^2 / |J_qp|
    connection.start_direction = -path->end_direction;
    connection.end_direction = -path->start_direction;
    connection.spreading *= n_p / n_q * (n_p / n_q);
  }
  search.for_each_segment(*path, random, [&](Part part, const RayState& start, double length) {
    connection.optical_depth += segments.reference(part) * length;
    connection.transmittance *= segments.transmitted(part, start, length, random);
  });
  return connection;
}

}  // namespace flatspeckle::grin
