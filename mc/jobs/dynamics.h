#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/keys/keys.h"
#include "flatland/scene/scene.h"
#include "mc/jobs/contrast.h"
#include "mc/jobs/motion.h"

namespace flatspeckle::mc {

/// Values of the keys of moving scatterers. Times and the diffusion constant are texts, because
/// their meaning depends on whether they have a unit (make_dynamics()).
struct DynamicsValues {
  std::vector<std::string> delays{}, exposures{};
  std::optional<std::string> diffusion;
  std::optional<double> temperature, viscosity, particle_radius, shear;
  std::vector<double> velocity{};
  double beta = 1;
};
void add_keys(Keys& keys, DynamicsValues& values);
/// Adds only the keys of the motion during delays.
void add_motion_keys(Keys& keys, DynamicsValues& values);

/// Delays between the two fields of a covariance, and the motion of the scatterers during them.
struct Dynamics {
  std::vector<double> delays{};
  Motion motion{};  ///< per unit of the delays
  /// Diffusion constant D in m^2/s. If it is set, delays and exposures are in s, otherwise in the
  /// unit of the reciprocal motion.diffusion.
  std::optional<double> diffusion{};
  Exposure exposure{};
};

/// Reads the keys of moving scatterers if delays are given. Times are in s if the diffusion
/// constant is given in m^2/s (or another unit of that dimension) or by temperature and viscosity;
/// this requires the scene's unit of length in metres. Otherwise times and diffusion are plain
/// numbers. Throws InputError for other combinations.
Dynamics make_dynamics(const Keys& keys, const DynamicsValues& values, const SceneSpec& spec,
                       const std::optional<double>& metres);

/// Returns the diffusion constant k_B T / (6 pi eta a) of a sphere of radius a in a liquid, in
/// m^2/s (Stokes and Einstein [einstein1905]). temperature in K, viscosity in Pa s, radius in m.
double stokes_einstein(double temperature, double viscosity, double radius);

}  // namespace flatspeckle::mc
