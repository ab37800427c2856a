#pragma once

#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "flatland/scene/scene.h"
#include "mc/jobs/motion.h"

namespace flatspeckle::mc {

/// A scene and the motion of its scatterers during a measurement.
struct MovingSpec : SceneSpec {
  double diffusion = 1, velocity_x = 0, velocity_z = 0, shear = 0, beta = 1;
  double detector_scale = 1;

  Motion motion() const { return {diffusion, {velocity_x, velocity_z}, shear}; }
  /// Whether the scatterers only diffuse, which transport solutions can model.
  bool only_diffuses() const { return velocity_x == 0 && velocity_z == 0 && shear == 0; }
};

/// Adds only the keys of the motion.
void add_motion_keys(Keys& keys, MovingSpec& spec);
/// Adds only the key of the scale of reflectances at distances.
void add_scale_key(Keys& keys, MovingSpec& spec);
/// Adds all keys of a MovingSpec. Keyed<MovingSpec> calls this function.
void add_keys(Keys& keys, MovingSpec& spec);

/// A scene key that is fitted within bounds. The fit takes steps in a coordinate: -log(1 - g) for
/// g, the logarithm of positive quantities without an upper bound, and other values themselves.
/// Thick media determine only the combination mu_s (1 - g). In these coordinates, media with equal
/// mu_s (1 - g) lie nearly on a straight line.
struct FreeParameter {
  enum class Scale { linear, logarithmic, to_one };
  std::string key;
  double lower = 0, upper = 0;
  std::optional<double> start;  ///< start value of the search; if empty, several are tried
  Scale scale = Scale::linear;

  double coordinate(double value) const;
  double value(double coordinate) const;
  double derivative(double coordinate) const;  ///< d value / d coordinate
};

/// Parses texts such as "g=0.5:0.99"; a value that the scene gives to the key is its start. Throws
/// InputError for malformed texts, for keys that are not numbers, for bounds that the key does not
/// accept, and for starts outside them.
std::vector<FreeParameter> read_free_parameters(const std::vector<std::string>& texts,
                                                const MovingSpec& scene);

/// Returns the scene with the values of the parameters at these coordinates.
MovingSpec with_parameters(const MovingSpec& scene, const std::vector<FreeParameter>& free,
                           const Eigen::VectorXd& coordinates);

Eigen::VectorXd lower_coordinates(const std::vector<FreeParameter>& free);
Eigen::VectorXd upper_coordinates(const std::vector<FreeParameter>& free);

}  // namespace flatspeckle::mc
