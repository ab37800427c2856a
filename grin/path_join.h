#pragma once

#include "grin/transport.h"

namespace flatspeckle::grin {

/// A curve from a vertex of a light path to one of a sensor's path, as far as it matters here.
struct JoiningCurve {
  Vec3 start_direction, end_direction;  ///< unit tangents
  double spreading;                     ///< |J| from the light's vertex to the sensor's
  double optical_depth;                 ///< reference extinction
};

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

/// from_y, from_z: leaving() along the curve, either way.
inline JoinedPath joined_path(const Strategies& strategies, const PathVertex& y,
                              const EndDirection& from_y, const PathVertex& z,
                              const EndDirection& from_z, const JoiningCurve& curve) {
  const double value = y.weight * from_y.strength * from_z.strength * z.weight /
                       (z.index * z.index * curve.spreading);
  if (!(value > 0)) return {};
  const double attenuation = bounded_attenuation(curve.optical_depth);
  const double turned = z.index / y.index * (z.index / y.index);
  const double y_from_z =
      from_z.density * attenuation / (curve.spreading * turned) * y.cosine(curve.start_direction);
  const double z_from_y =
      from_y.density * attenuation / curve.spreading * z.cosine(curve.end_direction);
  // a path goes on from an end that was not chosen
  const double others =
      fewer_of_ours(y, y_from_z, from_y.density, strategies.most_sensor() - z.vertices,
                    strategies.share(y.vertices - 1, z.vertices + 1)) /
          heuristic(z.choice()) +
      fewer_of_ours(z, z_from_y, from_z.density, strategies.most_light() - y.vertices,
                    strategies.share(y.vertices + 1, z.vertices - 1)) /
          heuristic(y.choice());
  const double share = strategies.share(y.vertices, z.vertices);
  return {value, share / (share + others), from_z.pixel};
}

}  // namespace flatspeckle::grin
