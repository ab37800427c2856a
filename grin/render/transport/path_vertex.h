#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

#include "grin/render/endpoints/path_end.h"

namespace flatspeckle::grin {

/// Probability, assumed in MIS weights, that a search finds a specular connection; 1 for
/// connections without interface crossings. Searches for specular connections have a higher
/// variance than competing strategies, which grows as the Fresnel probability falls and as
/// interface crossings are added: through nested balls at most one trial in 1e4 succeeds. At
/// surfaces with concave parts (RayJump) a connection is found from fewer start directions the more
/// it spreads light, and an estimator that only uses connections has no finite variance.
///
/// wider: n^2 |J| / (optical path)^2 with n at the end of the path; 1 for straight lines.
inline double specular_connection_probability(int crossings, double fresnel, int concave_crossings,
                                              double wider) {
  if (crossings == 0) return 1;
  constexpr int easy = 2;
  // tuned on nested balls, and on triangle meshes of rings and balls
  const double share =
      0.03 * std::max(fresnel, 1e-40) * std::pow(0.2, std::max(crossings - easy, 0));
  return concave_crossings == 0
             ? share
             : share * std::pow(0.3, concave_crossings) / std::clamp(wider, 1.0, 1e40);
}

/// Weight of a competing strategy in multiple importance sampling, from the ratio of its density to
/// that of the current strategy: power heuristic [veach1995] with exponent 2 ([veach1997], 9.2.4).
inline double heuristic(double ratio) {
  return ratio * ratio;
}

/// Transmittance as used in MIS weights, bounded from below so that its square does not underflow.
inline double bounded_attenuation(double optical_depth) {
  return std::exp(-std::min(optical_depth, 100.0));
}

/// Sampling strategies in use. A light or sensor path is called short if it ends as soon as paths
/// from the other endpoint can connect to it or hit it. It then consists of its endpoint only,
/// unless the endpoint is a beam or no connection can find the next segment.
struct Strategies {
  static constexpr int unlimited = std::numeric_limits<int>::max() / 2;
  bool short_light = false;   ///< true for path tracing: light paths are short
  bool short_sensor = false;  ///< true for light tracing: sensor paths are short
  /// Fraction of the pairs of kept scattering vertices, one of the light path and one of the sensor
  /// path, that are connected. One connected pair represents many; MIS weights account for this.
  double connected_fraction = 1;
  /// Probability that a vertex of a path is kept for these connections if the previous one was.
  /// Below 1 it limits the variance: two very long paths that come close do so repeatedly, which is
  /// rare and contributes much. Vertices that are not kept are still connected to the other
  /// endpoint.
  double kept = 1;
  /// Whether collisions of sensor paths are connected to beams (beam_connection.h).
  bool connects_beams = false;

  /// Maximum number of vertices sampled from the light, or from the sensor, in any strategy.
  int most_light() const { return short_light ? 1 : unlimited; }
  int most_sensor() const { return short_sensor ? 1 : unlimited; }
};

/// Sums of heuristic() over strategies that compete with the current one. connected: strategies
/// that connect two scattering vertices; at_endpoints: strategies that connect a vertex to an
/// endpoint or hit one. The densities of strategies in `connected` also contain connected_fraction
/// and the probability that both vertices are kept. Both factors are the same for all connections
/// along a path, and are left out until the path is complete.
struct CompetingStrategies {
  double connected = 0, at_endpoints = 0;
};

/// A vertex of a subpath. The subpath begins at a light or at the sensor, called our endpoint; "the
/// other side" is the subpath from the other endpoint. MIS weights depend on earlier vertices only
/// through numbers stored here, so that the cost of a path is linear in its length (as in Georgiev,
/// Krivanek, Davidovic and Slusallek [georgiev2012], light transport simulation with vertex
/// connection and merging, but for curved rays).
///
/// A path of k+1 vertices has a strategy for each number of vertices sampled from the light. Two
/// neighbouring strategies differ in one vertex, which is sampled from the light in one of them and
/// from the sensor in the other. The ratio of the densities of the strategies is the ratio of the
/// two densities of this vertex (per area on a surface; per volume and mu_t in a medium). Each of
/// these is the density of the direction at the vertex from which it is sampled, times the
/// attenuation, times the cosine if it is on a surface, times 1/|J| instead of 1/r^2.
struct PathVertex {
  PathPoint point;
  Vec3 arrived = Vec3::Zero();  ///< unit tangent of the arriving ray; 0 at our endpoint
  double index = 1;
  double weight = 1;  ///< throughput of the subpath, before the next direction is sampled
  double optical_path = 0;
  int vertices = 1;  ///< number of vertices of the subpath, including this one
  /// Probability that the vertex is kept for connections (Strategies::kept); at our endpoint it is
  /// extrapolated and above 1.
  double kept = 1;
  const EndPosition* end = nullptr;  ///< set at our endpoint only

  double density = 1;  ///< density with which the vertex was sampled
  /// Density of the previous vertex if it is sampled from this vertex, divided by the density of
  /// the direction to it.
  double back = 0;
  /// Sum over the strategies in which our side does not sample the previous vertex, relative to the
  /// strategy in which the previous vertex is the last of our side. The heuristic of the previous
  /// vertex's density, as sampled from here, is left out as a factor.
  CompetingStrategies before;
  /// Factor of the strategy in which the other side samples this vertex and our side ends at the
  /// previous one, so that the two are connected. 0 if there is no such strategy; else the
  /// heuristic of specular_connection_probability(), and of EndPosition::choice if our side then
  /// consists of its endpoint only. At our endpoint: 1 if the other side can hit it, else 0.
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

/// Returns the sum over the strategies in which the other side samples `last`, or `last` and
/// vertices before it, relative to the strategy in which `last` is the last vertex of our side.
/// first: factor of the strategy in which the other side samples only `last` of these; rest: factor
/// of the remaining strategies. others: number of vertices of the other side in the current
/// strategy.
inline CompetingStrategies fewer_of_ours(const PathVertex& last, double first, double rest,
                                         int others) {
  CompetingStrategies fewer{rest * last.before.connected, rest * last.before.at_endpoints};
  const bool both_scatter = last.vertices > 2 && others > 0;
  (both_scatter ? fewer.connected : fewer.at_endpoints) += first * last.first_of_other;
  return fewer;
}

/// Returns the vertex at the end of a flight from `here`. Its MIS densities are set by weigh().
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

/// Sets the MIS densities of `next` after the flight from `here` to it. direction_density: density
/// of the direction of the flight; 1 for a beam. It also serves for the reversed direction, since
/// phase functions are symmetric. choice: if `here` is our endpoint, its EndPosition::choice for a
/// connection from `next`. If `next` is on a surface, its density does not yet include the cosine
/// there.
inline void weigh(PathVertex& next, const Strategies& strategies, const PathVertex& here,
                  const Flight& flight, double direction_density, double choice) {
  const double turned = next.index / here.index * (next.index / here.index);
  // any value of |J| cancels if no strategy connects this segment
  const double spreading = !flight.is_connectable ? 1 : std::max(flight.spreading, 1e-60);
  const double attenuation = bounded_attenuation(flight.optical_depth);
  next.kept = here.kept * strategies.kept;
  next.density = direction_density * attenuation / spreading;
  next.back = attenuation / (spreading * turned) * here.cosine(flight.start_direction);
  // number of vertices of the other side: `here` and, if that scatters, `next`; it matters only
  // that others > 0
  constexpr int others = 2;
  next.before = fewer_of_ours(here, 1 / heuristic(here.density),
                              heuristic(direction_density * here.back / here.density), others);
  const bool can_be_connected = flight.is_connectable && !(here.end && here.end->is_beam);
  const double share = specular_connection_probability(
      flight.crossings.count, flight.fresnel, flight.concave_crossings,
      spreading * std::pow(next.index / flight.optical_path, 2));
  next.first_of_other = can_be_connected ? heuristic(share * choice) : 0;
}

}  // namespace flatspeckle::grin
