#pragma once

#include <optional>

#include "grin/render/flights/space.h"
#include "grin/render/transport/transport.h"

namespace flatspeckle::grin {

/// What joins two vertices.
struct JoinedPath {
  double value = 0;   ///< what the path adds, but for transmittance and multiplicity
  double weight = 0;  ///< among the strategies that could have made it
  int pixel = -1;     ///< where the sensor's vertex is its end
};

/// Strength and density of the way on from a vertex (path_end.h); in a medium both are the phase
/// function.
template <class End>
EndDirection leaving(const Transport& transport, const End& end, const PathVertex& vertex,
                     const Vec3& direction) {
  if (vertex.end) return end.towards(*vertex.end, direction);
  const double p = transport.medium(vertex.point.part).phase.density(vertex.arrived.dot(direction));
  return {direction, p, p};
}

/// Densities, relative to the strategy at hand, of those with fewer vertices on the side of `last`,
/// at most `more` fewer. made_from_other: density of `last` if made from the other side, which made
/// `others` vertices; direction_density: at `last`, from there towards the vertex before;
/// share: how often two vertices that both scatter are joined on this path.
inline double rivals(const PathVertex& last, double made_from_other, double direction_density,
                     int more, int others, double share) {
  if (more <= 0) return 0;
  const double first = heuristic(made_from_other / last.density);
  const double rest = more > 1 ? first * heuristic(direction_density * last.back) : 0;
  const Rivals fewer = fewer_of_ours(last, first, rest, others);
  return fewer.joined * heuristic(share) + fewer.at_ends;
}

/// Of all others where the path hit the other end at `last`, at a place and in a direction that the
/// other end has with these densities.
inline double rivals_of_hit(const Strategies& strategies, const PathVertex& last,
                            double position_density, double direction_density, int more) {
  const double share = strategies.joined_share * last.kept / heuristic(strategies.kept);
  return rivals(last, position_density, direction_density, more, 0, share);
}

/// curve: from y to z; its transmittance and multiplicity are left out. from_y, from_z: leaving()
/// along it, either way.
inline JoinedPath joined_path(const Strategies& strategies, const PathVertex& y,
                              const EndDirection& from_y, const PathVertex& z,
                              const EndDirection& from_z, const Join& curve) {
  const double value = y.weight * from_y.strength * from_z.strength * z.weight /
                       (z.index * z.index * curve.spreading);
  if (!(value > 0)) return {};
  const double attenuation = bounded_attenuation(curve.optical_depth);
  const double turned = z.index / y.index * (z.index / y.index);
  const double y_from_z =
      from_z.density * attenuation / (curve.spreading * turned) * y.cosine(curve.start_direction);
  const double z_from_y =
      from_y.density * attenuation / curve.spreading * z.cosine(curve.end_direction);
  const double share = strategies.joined_share * y.kept * z.kept;
  // a path goes on from an end that was not chosen
  const double others =
      rivals(y, y_from_z, from_y.density, strategies.most_sensor() - z.vertices, z.vertices,
             share) /
          heuristic(z.choice()) +
      rivals(z, z_from_y, from_z.density, strategies.most_light() - y.vertices, y.vertices, share) /
          heuristic(y.choice());
  const double wider = curve.spreading * std::pow(z.index / curve.optical_path, 2);
  const double ours =
      (y.end || z.end ? 1 : heuristic(share)) *
      heuristic(found_share(curve.passages.count, curve.fresnel, curve.hollows, wider));
  return {value, ours / (ours + others), from_z.pixel};
}

// Collisions of sensors' paths are joined to the light of beams that reaches them without one:
// along the plainest way (space.h), backwards, which is the same each time. It is shared with light
// paths whose first flight goes that way.

/// Where light that goes straight on would come from; nothing behind the plane of the beam, whose
/// light is not joined.
inline std::optional<Vec3> straight_place(const ParallelLight& light, const Vec3& x) {
  const double length = (x - light.x).dot(light.direction);
  if (!(length > 0)) return std::nullopt;
  return x - length * light.direction;
}

/// Weights of a light path's first collision, after weigh().
inline void weigh_in_beam(const Transport& transport, const Space& space, const PathVertex& start,
                          const Flight& flight, RandomStream& random, TransportCounts& counts,
                          PathVertex& next) {
  constexpr double same = 1e-4;  // rad
  const StageLights::Beam beam = transport.lights.beam_of(*start.end);
  const ParallelLight light = beam.light();
  if (!flight.is_joinable || flight.passages.reflected || !straight_place(light, flight.point.x))
    return;
  const auto way = space.plainest_way_to_beam(flight.point, light, random, counts.connections);
  if (!way || way->passages.count != flight.passages.count ||
      !((way->start_direction + flight.direction).norm() < same))
    return;
  next.density =
      beam.disk.density(start.point.x) * bounded_attenuation(flight.optical_depth) / way->thinning;
  next.first_of_other = 1;
}

/// A collision of a sensor's path as joined to the beam at `end`. density: of the place on the beam
/// that the way comes from. The curve's spreading is what thins the light.
inline JoinedPath joined_to_beam(const Transport& transport, const EndPosition& end, double density,
                                 const PathVertex& z, const EndDirection& from_z,
                                 const Join& curve) {
  PathVertex y = end_vertex(transport.strategies, end);
  y.weight = 1;
  const EndDirection from_y{curve.start_direction, density, transport.lights.power() * density};
  return joined_path(transport.strategies, y, from_y, z, from_z, curve);
}
/// Along a way.
inline JoinedPath joined_to_beam(const Transport& transport, const EndPosition& end,
                                 const BeamWay& way, const PathVertex& z,
                                 const EndDirection& from_z) {
  const LightDisk& disk = transport.lights.beam_of(end).disk;
  return joined_to_beam(transport, end, disk.density(way.place), z, from_z,
                        {.start_direction = disk.axis(),
                         .end_direction = -way.start_direction,
                         .spreading = way.thinning,
                         .optical_depth = way.optical_depth});
}

}  // namespace flatspeckle::grin
