#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

#include "grin/render/endpoints/path_end.h"

namespace flatspeckle::grin {

/// What weights take for the density of ways found by search, over that of other joins: sums over
/// such ways vary more than what else makes a path, where there is something else, and the fainter
/// a way is, by Fresnel's chance of it, and the more often it is refracted or reflected, the more:
/// one trial of 1e4 or less finds ways through balls in balls. By hollow surfaces (RayJump) the
/// more a way spreads light, the fewer directions it is found from, and sums over such ways have no
/// finite variance by themselves.
///
/// wider: n^2 |J| over the square of the optical path, n at its end; 1 of straight lines.
inline double found_share(int passages, double fresnel, int hollows, double wider) {
  if (passages == 0) return 1;
  constexpr int easy = 2;
  // found by trials with balls in balls, and with rings and balls of triangles
  const double share =
      0.03 * std::max(fresnel, 1e-40) * std::pow(0.2, std::max(passages - easy, 0));
  return hollows == 0 ? share : share * std::pow(0.3, hollows) / std::clamp(wider, 1.0, 1e40);
}

/// What a ratio of densities counts in the weights of multiple importance sampling (power
/// heuristic, Veach 1997, 9.2.4).
inline double heuristic(double ratio) {
  return ratio * ratio;
}

/// The share of light that a stretch lets through, as weights see it: never so small that its
/// square is 0.
inline double bounded_attenuation(double optical_depth) {
  return std::exp(-std::min(optical_depth, 100.0));
}

/// Which strategies are in use. A short path from an end stops where the rest can be joined to it
/// or hits it: after the end itself, but for a beam, and for ways that cannot be joined.
struct Strategies {
  static constexpr int unlimited = std::numeric_limits<int>::max() / 2;
  bool short_light = false;   ///< path tracing
  bool short_sensor = false;  ///< light tracing
  /// How often two vertices that both scatter are joined, of the pairs of them that are kept for
  /// it: one stands for many, which weights should know.
  double joined_share = 1;
  /// The chance that a path's next vertex is kept for such joins, where this one was. Two very long
  /// paths that meet do so again and again, which is rare and worth much; without these joins they
  /// still meet each other's end.
  double kept = 1;
  /// Collisions of sensors' paths are joined to beams (beam_join.h).
  bool joins_beams = false;

  /// Vertices made from an end that can also be made from the other.
  int most_light() const { return short_light ? 1 : unlimited; }
  int most_sensor() const { return short_sensor ? 1 : unlimited; }
};

/// Densities of strategies relative to one at hand, as weights count them: of those that join two
/// vertices that both scatter, and of those that join an end or hit it. The former count by the
/// chance that both are kept, the same for all of a path, and by joined_share: these are left out
/// until the path is whole.
struct Rivals {
  double joined = 0, at_ends = 0;
};

/// A vertex of a subpath that begins at a light or at the sensor, "our end". All that weights need
/// of the vertices before it is in three numbers, so that a path costs in proportion to its length
/// (as in Georgiev, Krivanek, Davidovic and Slusallek 2012, light transport simulation with vertex
/// connection and merging, but for curved rays).
///
/// A path of k+1 vertices has a strategy for each number of vertices made from the light. Two
/// neighbouring strategies differ by who made one vertex: the ratio of their densities is that of
/// the two densities of this vertex (per area on a surface; per volume and mu_t in a medium), each
/// the density of the direction at the vertex it was made from, times the attenuation, the cosine
/// on a surface, and 1/|J| instead of 1/r^2.
struct PathVertex {
  PathPoint point;
  Vec3 arrived = Vec3::Zero();  ///< unit tangent of the way here; 0 at our end
  double index = 1;
  double weight = 1;  ///< of the subpath, without the direction in which it goes on
  double optical_path = 0;
  int vertices = 1;  ///< of the subpath, this one included
  double kept = 1;   ///< chance that it is (Strategies); of our end as if it came before
  const EndPosition* end = nullptr;  ///< at our end

  double density = 1;  ///< with which it was made
  double back = 0;     ///< that of the vertex before, made from here, per density of the direction
  /// Of the strategies with fewer of our vertices than made the vertex before this: sum of their
  /// densities relative to that strategy's, per density of the vertex before as made from here.
  Rivals before;
  /// Of the strategy in which this is the first vertex from the other end: 0 if there is none, 1
  /// or less (found_share) if there is; where our end alone is left, what its choice counts
  /// (EndPosition).
  double first_of_other = 0;

  double choice() const { return end ? end->choice : 1; }
  bool on_surface() const { return end && !end->is_point; }
  double cosine(const Vec3& direction) const {
    return on_surface() ? std::abs(end->inward.dot(direction)) : 1;
  }
};

inline PathVertex end_vertex(const Strategies& strategies, const EndPosition& end) {
  PathVertex vertex;
  vertex.point = end.point;
  vertex.index = end.index;
  vertex.end = &end;
  vertex.kept = 1 / strategies.kept;
  vertex.density = end.position_density * end.choice;
  vertex.weight = 1 / vertex.density;
  vertex.first_of_other = !end.is_point && !end.is_beam;
  return vertex;
}

/// The strategies in which `last`, and vertices before it, are made from the other side, relative
/// to the one in which it is our last: `first` is that in which it alone is, `rest` the others. The
/// other side made `others` vertices in the strategy at hand.
inline Rivals fewer_of_ours(const PathVertex& last, double first, double rest, int others) {
  Rivals fewer{rest * last.before.joined, rest * last.before.at_ends};
  const bool both_scatter = last.vertices > 2 && others > 0;
  (both_scatter ? fewer.joined : fewer.at_ends) += first * last.first_of_other;
  return fewer;
}

/// Where a flight from `here` ended, before it is weighed.
inline PathVertex moved(const PathVertex& here, const Flight& flight, double index) {
  PathVertex next;
  next.point = flight.point;
  next.arrived = flight.direction;
  next.index = index;
  next.weight = here.weight * flight.weight;
  next.optical_path = here.optical_path + flight.optical_path;
  next.vertices = here.vertices + 1;
  return next;
}

/// What weights need to know of the flight to `next`. The direction was drawn with
/// `direction_density` (1 of a beam; phase functions have the same both ways). `choice`: of `here`
/// if that is our end and were chosen from there. On a surface, `density` still lacks the cosine
/// there.
inline void weigh(PathVertex& next, const Strategies& strategies, const PathVertex& here,
                  const Flight& flight, double direction_density, double choice) {
  const double turned = next.index / here.index * (next.index / here.index);
  // what weights take for |J| of a way that no strategy joins cancels
  const double spreading = !flight.is_joinable ? 1 : std::max(flight.spreading, 1e-60);
  const double attenuation = bounded_attenuation(flight.optical_depth);
  next.kept = here.kept * strategies.kept;
  next.density = direction_density * attenuation / spreading;
  next.back = attenuation / (spreading * turned) * here.cosine(flight.start_direction);
  constexpr int others = 2;  // they made `here` and, where that counts, the next
  next.before = fewer_of_ours(here, 1 / heuristic(here.density),
                              heuristic(direction_density * here.back / here.density), others);
  const bool can_be_joined = flight.is_joinable && !(here.end && here.end->is_beam);
  const double share = found_share(flight.passages.count, flight.fresnel, flight.hollows,
                                   spreading * std::pow(next.index / flight.optical_path, 2));
  next.first_of_other = can_be_joined ? heuristic(share * choice) : 0;
}

}  // namespace flatspeckle::grin
