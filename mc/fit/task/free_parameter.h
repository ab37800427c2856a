#pragma once

#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "flatland/scene/scene.h"
#include "mc/jobs/motion.h"

namespace flatspeckle::mc {

/// A scene and how its scatterers move while it is measured.
struct MovingSpec : SceneSpec {
  double diffusion = 1, velocity_x = 0, velocity_z = 0, shear = 0, beta = 1;

  Motion motion() const { return {diffusion, {velocity_x, velocity_z}, shear}; }
  /// Diffusion alone, which transport can do.
  bool only_diffuses() const { return velocity_x == 0 && velocity_z == 0 && shear == 0; }
};

/// Of the motion alone.
void add_motion_keys(Keys& keys, MovingSpec& spec);
/// All, found by the struct's name (Keyed).
void add_keys(Keys& keys, MovingSpec& spec);

/// A key of the scene that is fitted, within bounds. Steps are taken in a coordinate that makes a
/// straight line of what thick media alone tell, mu_s (1 - g): the logarithm of 1 - g and of what
/// is positive without bound.
struct FreeParameter {
  enum class Scale { linear, logarithmic, to_one };
  std::string key;
  double lower = 0, upper = 0;
  std::optional<double> start;  ///< without one a grid of starts
  Scale scale = Scale::linear;

  double coordinate(double value) const;
  double value(double coordinate) const;
  double slope(double coordinate) const;  ///< of the value by the coordinate
};

/// Of texts such as "g=0.5:0.99"; the value that the scene gives a key is where it starts. Throws
/// InputError for what is no such text, for keys that are no number, for bounds that the key does
/// not accept, and for starts beyond them.
std::vector<FreeParameter> read_free_parameters(const std::vector<std::string>& texts,
                                                const MovingSpec& scene);

/// The scene with the values of the parameters at these coordinates.
MovingSpec with_parameters(const MovingSpec& scene, const std::vector<FreeParameter>& free,
                           const Eigen::VectorXd& coordinates);

Eigen::VectorXd lower_coordinates(const std::vector<FreeParameter>& free);
Eigen::VectorXd upper_coordinates(const std::vector<FreeParameter>& free);

}  // namespace flatspeckle::mc
