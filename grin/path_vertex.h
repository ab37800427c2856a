#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

#include "grin/path_end.h"

namespace flatspeckle::grin {

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
/// or hits it: after the end itself, but for a beam, and for ways that cross a body.
struct Strategies {
  static constexpr int unlimited = std::numeric_limits<int>::max() / 2;
  bool short_light = false;   ///< path tracing
  bool short_sensor = false;  ///< light tracing
  /// How often two vertices that both scatter are joined, of the pairs of them that a light path
  /// and a sensor's path have: one stands for many, which weights should know.
  double joined_share = 1;

  /// Vertices made from an end that can also be made from the other.
  int most_light() const { return short_light ? 1 : unlimited; }
  int most_sensor() const { return short_sensor ? 1 : unlimited; }

  /// What the density of a strategy of so many vertices from the light and from the sensor counts,
  /// beside the densities of its vertices.
  double share(int from_light, int from_sensor) const {
    return from_light > 1 && from_sensor > 1 ? heuristic(joined_share) : 1;
  }
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
  int vertices = 1;                  ///< of the subpath, this one included
  const EndPosition* end = nullptr;  ///< at our end

  double density = 1;  ///< with which it was made
  double back = 0;     ///< that of the vertex before, made from here, per density of the direction
  /// Of the strategies with fewer of our vertices than made the vertex before this: sum of their
  /// densities relative to that strategy's, per density of the vertex before as made from here.
  double before = 0;
  /// Of the strategy in which this is the first vertex from the other end: 0 if there is none, 1 if
  /// there is; where our end alone is left, what its choice counts (EndPosition).
  double first_of_other = 0;

  double choice() const { return end ? end->choice : 1; }
  bool on_surface() const { return end && !end->is_point; }
  double cosine(const Vec3& direction) const {
    return on_surface() ? std::abs(end->inward.dot(direction)) : 1;
  }
};

inline PathVertex end_vertex(const EndPosition& end) {
  PathVertex vertex;
  vertex.point = end.point;
  vertex.index = end.index;
  vertex.end = &end;
  vertex.density = end.position_density * end.choice;
  vertex.weight = 1 / vertex.density;
  vertex.first_of_other = !end.is_point && !end.is_beam;
  return vertex;
}

/// Densities of the strategies with fewer of our vertices, relative to the one at hand, in which
/// `last` is our last. `made_from_other`: density of `last` if made from the other side;
/// `direction_density`: at `last`, from the other side towards the vertex before. No more than
/// `more` vertices can be made from the other side than are. `share`: Strategies::share() of the
/// strategy with one of ours less.
inline double fewer_of_ours(const PathVertex& last, double made_from_other,
                            double direction_density, int more, double share) {
  if (more <= 0) return 0;
  const double rest = more > 1 ? heuristic(direction_density * last.back) * last.before : 0;
  return heuristic(made_from_other / last.density) * (share * last.first_of_other + rest);
}

/// Where a flight from `here` ended. The direction was drawn with `direction_density` (1 of a beam;
/// phase functions have the same both ways). `choice`: of `here` if that is our end and were chosen
/// from there. On a surface, `density` still lacks the cosine there.
inline PathVertex arrived(const Strategies& strategies, const PathVertex& here,
                          const Flight& flight, double direction_density, double choice,
                          double index) {
  const double turned = index / here.index * (index / here.index);
  // what weights take for |J| of a way that no strategy joins cancels
  const double spreading = flight.crosses_body ? 1 : std::max(flight.spreading, 1e-60);
  const double attenuation = bounded_attenuation(flight.optical_depth);
  PathVertex next;
  next.point = flight.point;
  next.arrived = flight.direction;
  next.index = index;
  next.weight = here.weight * flight.weight;
  next.optical_path = here.optical_path + flight.optical_path;
  next.vertices = here.vertices + 1;
  next.density = direction_density * attenuation / spreading;
  next.back = attenuation / (spreading * turned) * here.cosine(flight.start_direction);
  // the other end made `here` and, where that counts, at least two more
  const double share = strategies.share(here.vertices - 1, 2);
  next.before =
      (share * here.first_of_other + heuristic(direction_density * here.back) * here.before) /
      heuristic(here.density);
  const bool can_be_joined = !flight.crosses_body && !(here.end && here.end->is_beam);
  next.first_of_other = can_be_joined ? heuristic(choice) : 0;
  return next;
}

}  // namespace flatspeckle::grin
