#pragma once

#include <string>
#include <vector>

#include <Eigen/Core>

#include "mc/fit/task/field_sample.h"
#include "mc/fit/task/moving_spec.h"

namespace flatspeckle::mc {

/// What is measured: C_E or C_I of each move, summed over the views (C19), or |g1| and |g1|^2 after
/// each delay; variances of the field, [light][view]; shares of the power of each light; K^2 after
/// each exposure; covariances of fields, the lower triangle of one matrix, packed (field_sample.h).
enum class Observable {
  field_correlation,
  intensity_correlation,
  intensity,
  reflectance,
  transmittance,
  squared_contrast,
  field_covariance
};
/// By their names in files.
inline const std::vector<std::string> observable_words = {
    "field_correlation", "intensity_correlation", "intensity",       "reflectance",
    "transmittance",     "squared_contrast",      "field_covariance"};

/// Values of one observable.
struct Curve {
  MovingSpec scene;  ///< all of it: what is free has its start or none
  Observable observable = Observable::field_correlation;
  std::vector<std::size_t> entries;  ///< of all that the scene has, those that were measured
  std::vector<double> abscissa;      ///< of each of them: tilt, view or light, radians, or time
  std::vector<double> times{};       ///< delays or exposures; entries then are [time][light][view]
  std::vector<double> delays{};      ///< after which the fields have to be known for that
  bool flows = true;                 ///< after delays magnitudes are measured, not real parts
  bool fixed_count = false;          ///< the number of scatterers was the same in all placements

  bool moving() const { return !delays.empty(); }
};

/// Curves whose errors are known together.
struct Measurement {
  std::string name;  ///< the file
  std::vector<Curve> curves;
  Eigen::VectorXd values;              ///< of all curves, one after the other
  Eigen::MatrixXd covariance;          ///< of their errors
  bool guessed_independent = false;    ///< the file does not tell how its errors are correlated
  std::vector<FieldSample> samples{};  ///< of fields: each curve is the covariance of one
  bool by_paths = false;               ///< made by Monte Carlo, which neglects what the model does
};

}  // namespace flatspeckle::mc
