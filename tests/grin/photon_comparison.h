#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "grin/render/pictures/render_job.h"
#include "tests/oracles/photon_walk.h"

namespace flatspeckle::grin::tests {

using namespace oracles;

struct PhotonScore {
  int pixel;
  double score;
};
/// Returns the score of a photon that leaves the scene; nullopt if it is not detected.
using PhotonSensor = std::function<std::optional<PhotonScore>(const Photon&)>;

// Sensors of scenes, implemented a second time from their definitions.
PhotonSensor area_sensor(const AreaDetector& detector, const Vec3& outward,
                         double sphere_radius = 0);
PhotonSensor radial_sensor(const RadialDetector& detector, const Vec3& outward);
PhotonSensor polar_sensor(const PolarDetector& detector);
PhotonSensor directional_sensor(const DirectionalDetector& detector);
/// Returns a camera with a lens on a plane wall.
PhotonSensor lens_sensor(const Camera& camera);

/// One scene in two forms, for the estimators and for the photon walk.
struct TwoScenes {
  RenderScene scene;
  WalkScene walk;
  PhotonSource source;
  double power = 1;
  PhotonSensor sensor;
};

/// Picture by the photon walk: values per time bin, [pixel][bin], and time-integrated values,
/// [pixel].
struct PhotonPicture {
  std::vector<double> value, error, steady_value, steady_error;
};
PhotonPicture photon_picture(const TwoScenes& scenes, std::uint64_t photons, std::uint64_t seed);

/// Checks pixels, bins and totals of a method against the photon walk, each within 4 combined
/// standard errors, and that the relative error of the total is at most `precision`. `samples` and
/// the number of photons are given for nightly runs; by day they are reduced (see Effort).
void check_against(const PhotonPicture& photons, const TwoScenes& scenes,
                   const RenderRequest& request, std::uint64_t samples, double precision);

}  // namespace flatspeckle::grin::tests
