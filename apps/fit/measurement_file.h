#pragma once

#include <string>

#include "core/keys/keys.h"
#include "mc/fit/measurement.h"

namespace flatspeckle::apps {

/// A measurement that a file holds: a result of covariance, flux or sweep (HDF5), which brings its
/// depth, wavelength, lights, views and tilts, or a table (CSV) of one column that an observable
/// names, with columns error, or covariance_1, covariance_2 ..., and light_angle, view_angle and
/// tilt where they are not 0, depth where that is not the fit's. asked: keys of the fit; medium:
/// their values. Throws InputError.
mc::Measurement read_measurement(const std::string& path, const Keys& asked,
                                 const SceneSpec& medium);

/// The two kinds of files.
mc::Measurement measurement_of_table(const std::string& path, const SceneSpec& medium);
mc::Measurement measurement_of_result(const std::string& path, const Keys& asked,
                                      const SceneSpec& medium);

/// Of errors that must be positive: a diagonal matrix.
Eigen::MatrixXd independent_errors(const std::string& path, const std::vector<double>& errors);

}  // namespace flatspeckle::apps
