#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "grin/render/pictures/render_job.h"
#include "tests/oracles/photon_walk.h"

namespace flatspeckle::grin::tests {

using namespace oracles;

struct PhotonWorth {
  int pixel;
  double worth;
};
/// What a photon that leaves is worth to a sensor, nothing where it is not seen.
using PhotonSensor = std::function<std::optional<PhotonWorth>(const Photon&)>;

/// Sensors of scenes, written once more from their definitions.
PhotonSensor area_sensor(const AreaDetector& detector, const Vec3& outward,
                         double sphere_radius = 0);
PhotonSensor radial_sensor(const RadialDetector& detector, const Vec3& outward);
PhotonSensor polar_sensor(const PolarDetector& detector);
PhotonSensor directional_sensor(const DirectionalDetector& detector);
/// With a lens, on a plane wall.
PhotonSensor lens_sensor(const Camera& camera);

/// A scene twice: for the estimators and for the oracle.
struct TwoScenes {
  RenderScene scene;
  WalkScene walk;
  PhotonSource source;
  double power = 1;
  PhotonSensor sensor;
};

/// The oracle's picture, [pixel][bin] and the steady [pixel].
struct PhotonPicture {
  std::vector<double> value, error, steady_value, steady_error;
};
PhotonPicture photon_picture(const TwoScenes& scenes, std::uint64_t photons, std::uint64_t seed);

/// Checks pixels, bins and totals of a method against the oracle, each within 4 combined standard
/// errors, and that the error of the total is no more than `precision` of it. These and photons are
/// what is taken by night: see Effort.
void check_against(const PhotonPicture& photons, const TwoScenes& scenes,
                   const RenderRequest& request, std::uint64_t samples, double precision);

}  // namespace flatspeckle::grin::tests
