#pragma once

#include <optional>

#include "grin/render/flights/space.h"
#include "grin/render/transport/path_join.h"

namespace flatspeckle::grin {

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
  const Lights::Beam beam = transport.lights.beam_of(*start.end);
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
                                 const JoiningCurve& curve) {
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
                        {disk.axis(), -way.start_direction, way.thinning, way.optical_depth});
}

}  // namespace flatspeckle::grin
