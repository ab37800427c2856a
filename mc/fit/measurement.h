#pragma once

#include <string>
#include <vector>

#include <Eigen/Core>

#include "flatland/scene/scene.h"

namespace flatspeckle::mc {

/// What is measured: C_E or C_I of each move, summed over the views (C19); variances of the field,
/// [light][view]; shares of the power of each light.
enum class Observable {
  field_correlation,
  intensity_correlation,
  intensity,
  reflectance,
  transmittance
};
/// By their names in files.
inline const std::vector<std::string> observable_words = {
    "field_correlation", "intensity_correlation", "intensity", "reflectance", "transmittance"};

/// Values of one observable.
struct Curve {
  SceneSpec scene;  ///< all of it: what is free has its start or none
  Observable observable = Observable::field_correlation;
  std::vector<std::size_t> entries;  ///< of all that the scene has, those that were measured
  std::vector<double> abscissa;      ///< of each of them: tilt, view or light, radians
};

/// Curves whose errors are known together.
struct Measurement {
  std::string name;  ///< the file
  std::vector<Curve> curves;
  Eigen::VectorXd values;            ///< of all curves, one after the other
  Eigen::MatrixXd covariance;        ///< of their errors
  bool guessed_independent = false;  ///< the file does not tell how its errors are correlated
};

}  // namespace flatspeckle::mc
