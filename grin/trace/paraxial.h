#pragma once

#include <optional>

#include "grin/trace/trace_scene.h"

namespace flatspeckle::grin {

/// Paraxial properties of the optical system that a parallel beam passes, about the ray on the axis
/// of the beam. Where the system is astigmatic, they are means over two perpendicular directions.
struct ParaxialSystem {
  /// Rear focal length f' = -h / u' for a ray at the height h that leaves at the angle u'. The
  /// index behind the system is image_index; in air f' is the effective focal length.
  double focal_length;
  double image_index;
  double power;  ///< image_index / focal_length
  /// Distance of the paraxial focus from the last refracting surface along the axis; nullopt
  /// without bodies.
  std::optional<double> back_focal_length;
  double f_number;  ///< |focal_length| over the diameter of the beam
  Vec3 focus;       ///< paraxial focus
};

/// Traces rays close to the axis of the scene's beam, at two heights that are extrapolated to 0.
/// Returns nullopt if the light is not a parallel beam, if the axis does not reach the end of the
/// system, or if the system does not focus.
std::optional<ParaxialSystem> paraxial_system(const TraceScene& scene);

}  // namespace flatspeckle::grin
