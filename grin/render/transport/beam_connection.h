#pragma once

#include <optional>

#include "grin/render/flights/space.h"
#include "grin/render/transport/transport.h"

namespace flatspeckle::grin {

/// A full path from light to sensor, made by connecting two vertices.
struct ConnectedPath {
  double value = 0;   ///< contribution without transmittance and multiplicity
  double weight = 0;  ///< MIS weight among all strategies that can sample the path
  int pixel = -1;     ///< pixel hit if the connection ends on the sensor itself; else -1
};

/// Returns strength and density of the direction in which a path leaves a vertex (path_end.h); at a
/// collision both are the phase function.
template <class End>
EndDirection leaving(const Transport& transport, const End& end, const PathVertex& vertex,
                     const Vec3& direction) {
  if (vertex.end) return end.towards(*vertex.end, direction);
  const double p = transport.medium(vertex.point).phase.density(vertex.arrived.dot(direction));
  return {direction, p, p};
}

/// Returns the sum of heuristic() over the competing strategies in which `last`, and possibly
/// vertices before it, are sampled by the other subpath (the one from the other endpoint), relative
/// to the current strategy. made_from_other: density of `last` if the other subpath samples it.
/// direction_density: density of the direction from `last` to the previous vertex. more: largest
/// number of further vertices that the other subpath can sample. others: number of vertices that
/// the other subpath has. share: probability that a pair of scattering vertices of this path is
/// connected.
inline double competing_density(const PathVertex& last, double made_from_other,
                                double direction_density, int more, int others, double share) {
  if (more <= 0) return 0;
  const double first = heuristic(made_from_other / last.density);
  const double rest = more > 1 ? first * heuristic(direction_density * last.back) : 0;
  const CompetingStrategies fewer = fewer_of_ours(last, first, rest, others);
  return fewer.connected * heuristic(share) + fewer.at_endpoints;
}

/// Returns the sum of heuristic() over all strategies that compete with a path from one endpoint
/// that hits the other endpoint at `last`. position_density, direction_density: densities with
/// which that endpoint samples the position and the reversed direction of the hit. more: see
/// competing_density().
inline double competing_with_hit(const Strategies& strategies, const PathVertex& last,
                                 double position_density, double direction_density, int more) {
  const double share = strategies.connected_fraction * last.kept / heuristic(strategies.kept);
  return competing_density(last, position_density, direction_density, more, 0, share);
}

/// Connects y, a vertex of the light path, and z, a vertex of the sensor path, along `curve`.
/// Transmittance and multiplicity of the curve are left out. from_y, from_z: leaving() at y and at
/// z along the curve.
inline ConnectedPath connected_path(const Strategies& strategies, const PathVertex& y,
                                    const EndDirection& from_y, const PathVertex& z,
                                    const EndDirection& from_z, const TestConnection& curve) {
  const double value = y.weight * from_y.strength * from_z.strength * z.weight /
                       (z.index * z.index * curve.spreading);
  if (!(value > 0)) return {};
  const double attenuation = bounded_attenuation(curve.optical_depth);
  const double turned = z.index / y.index * (z.index / y.index);
  const double y_from_z =
      from_z.density * attenuation / (curve.spreading * turned) * y.cosine(curve.start_direction);
  const double z_from_y =
      from_y.density * attenuation / curve.spreading * z.cosine(curve.end_direction);
  const double share = strategies.connected_fraction * y.kept * z.kept;
  // strategies that sample more vertices from one endpoint do not choose its position for this
  // connection: the sums are divided by the factor choice() of that endpoint
  const double others =
      competing_density(y, y_from_z, from_y.density, strategies.most_sensor() - z.vertices,
                        z.vertices, share) /
          heuristic(z.choice()) +
      competing_density(z, z_from_y, from_z.density, strategies.most_light() - y.vertices,
                        y.vertices, share) /
          heuristic(y.choice());
  const double wider = curve.spreading * std::pow(z.index / curve.optical_path, 2);
  const double ours = (y.end || z.end ? 1 : heuristic(share)) *
                      heuristic(specular_connection_probability(
                          curve.crossings.count, curve.fresnel, curve.concave_crossings, wider));
  return {value, ours / (ours + others), from_z.pixel};
}

// Collisions of sensor paths are connected to the unscattered light of beams along the simplest
// connection (Space), which is traced backwards and is deterministic. MIS weights combine these
// connections with light paths whose first flight follows the same path.

/// Returns the point on the plane of the beam from which straight light would reach x; nullopt if x
/// is behind that plane, where no connection is made.
inline std::optional<Vec3> straight_place(const ParallelLight& light, const Vec3& x) {
  const double length = (x - light.x).dot(light.direction);
  if (!(length > 0)) return std::nullopt;
  return x - length * light.direction;
}

/// Adapts the MIS densities of a light path's first collision to the strategy that connects the
/// collision to its beam. Must be called after weigh().
inline void weigh_in_beam(const Transport& transport, const Space& space, const PathVertex& start,
                          const Flight& flight, RandomStream& random, TransportCounts& counts,
                          PathVertex& next) {
  constexpr double same = 1e-4;  // rad
  const StageLights::Beam beam = transport.lights.beam_of(*start.end);
  const ParallelLight light = beam.light();
  if (!flight.is_connectable || flight.crossings.reflected ||
      !straight_place(light, flight.point.x))
    return;
  const auto connection =
      space.simplest_connection_to_beam(flight.point, light, random, counts.connections);
  if (!connection || connection->crossings.count != flight.crossings.count ||
      !((connection->start_direction + flight.direction).norm() < same))
    return;
  next.density = beam.disk.density(start.point.x) * bounded_attenuation(flight.optical_depth) /
                 connection->thinning;
  next.first_of_other = 1;
}

/// Connects a collision of a sensor path to the beam at `end`. density: density per area of
/// positions on the beam, at the start of the connection. curve.spreading: thinning of the light
/// (BeamConnection).
inline ConnectedPath connected_to_beam(const Transport& transport, const EndPosition& end,
                                       double density, const PathVertex& z,
                                       const EndDirection& from_z, const TestConnection& curve) {
  PathVertex y = end_vertex(transport.strategies, end);
  y.weight = 1;
  const EndDirection from_y{curve.start_direction, density, transport.lights.power() * density};
  return connected_path(transport.strategies, y, from_y, z, from_z, curve);
}
/// Connects a collision of a sensor path to its beam along a connection that a search has found.
inline ConnectedPath connected_to_beam(const Transport& transport, const EndPosition& end,
                                       const BeamConnection& connection, const PathVertex& z,
                                       const EndDirection& from_z) {
  const LightDisk& disk = transport.lights.beam_of(end).disk;
  return connected_to_beam(transport, end, disk.density(connection.place), z, from_z,
                           {.start_direction = disk.axis(),
                            .end_direction = -connection.start_direction,
                            .spreading = connection.thinning,
                            .optical_depth = connection.optical_depth});
}

}  // namespace flatspeckle::grin
