#pragma once

#include <string>

#include "core/keys/csv.h"
#include "core/keys/keys.h"
#include "mc/fit/task/measurement.h"

namespace flatspeckle::apps {

/// A measurement that a file holds: a result of covariance, flux or sweep (HDF5), which brings its
/// depth, wavelength, lights, views, tilts, delays and exposures, or a table (CSV) of one column
/// that an observable names, with columns error, or covariance_1, covariance_2 ..., and
/// light_angle, view_angle where they are not 0, tilt, delay or exposure, depth where that is not
/// the fit's. asked: keys of the fit; medium:
/// their values. Throws InputError.
mc::Measurement read_measurement(const std::string& path, const Keys& asked,
                                 const mc::MovingSpec& medium);

/// The two kinds of files.
mc::Measurement measurement_of_table(const std::string& path, const mc::MovingSpec& medium);
mc::Measurement measurement_of_result(const std::string& path, const Keys& asked,
                                      const mc::MovingSpec& medium);

/// Tables of patterns, columns pattern, view_angle, tilt and field_re, field_im (up to a factor) or
/// speckle_intensity: covariances of the fields under the tilts, or C_I with the errors that follow
/// from the patterns.
mc::Measurement measurement_of_fields(const std::string& path, const Table& table,
                                      const mc::MovingSpec& medium);
mc::Measurement measurement_of_intensities(const std::string& path, const Table& table,
                                           const mc::MovingSpec& medium);
/// Of fields [pattern][light][view] that `field` has drawn.
mc::Measurement measurement_of_drawn_fields(const std::string& path, const mc::MovingSpec& scene,
                                            const std::vector<Complex>& fields);

/// A column of a table, or `value` in every row where there is none.
std::vector<double> column_or(const Table& table, const std::string& name, double value);

/// Of errors that must be positive: a diagonal matrix.
Eigen::MatrixXd independent_errors(const std::string& path, const std::vector<double>& errors);

}  // namespace flatspeckle::apps
