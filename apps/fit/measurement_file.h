#pragma once

#include <string>

#include "core/keys/csv.h"
#include "core/keys/keys.h"
#include "mc/distance/detector_keys.h"
#include "mc/fit/task/measurement.h"

namespace flatspeckle::apps {

/// Reads a measurement from a file. A result of covariance, flux or sweep (HDF5) also gives depth,
/// wavelength, lights, views, tilts, delays and exposures. A table (CSV) has one column named after
/// an observable, and standard errors in a column `error` or a covariance matrix in the columns
/// covariance_1, covariance_2 ... Optional columns are light_angle and view_angle (default 0),
/// tilt, delay or exposure, distance from a beam, and depth (default: the depth given to the fit).
/// fit_keys: keys of the fit; medium, detectors: values of these keys. Throws InputError.
mc::Measurement read_measurement(const std::string& path, const Keys& fit_keys,
                                 const mc::MovingSpec& medium, const mc::DetectorValues& detectors);

/// Read a measurement from a table (CSV) and from a result file (HDF5).
mc::Measurement measurement_of_table(const std::string& path, const Keys& fit_keys,
                                     const mc::MovingSpec& medium,
                                     const mc::DetectorValues& detectors);
mc::Measurement measurement_of_result(const std::string& path, const Keys& fit_keys,
                                      const mc::MovingSpec& medium);

/// Make measurements from tables of many speckle patterns. The columns are pattern, view_angle,
/// tilt, and either field_re and field_im (up to a common factor) or speckle_intensity. From
/// fields, the measured values are the covariances between fields under different tilts; from
/// intensities, the intensity correlations C_I. Their errors are estimated from the spread of the
/// patterns.
mc::Measurement measurement_of_fields(const std::string& path, const Table& table,
                                      const mc::MovingSpec& medium);
mc::Measurement measurement_of_intensities(const std::string& path, const Table& table,
                                           const mc::MovingSpec& medium);
/// Makes a measurement from random fields [pattern][light][view], as written by the subcommand
/// `field`.
mc::Measurement measurement_of_drawn_fields(const std::string& path, const mc::MovingSpec& scene,
                                            const std::vector<Complex>& fields);

/// Returns a column of a table. If the table lacks this column, returns `value` for every row.
std::vector<double> column_or(const Table& table, const std::string& name, double value);

/// Returns the diagonal covariance matrix that belongs to these independent standard errors. Throws
/// InputError unless all errors are positive.
Eigen::MatrixXd independent_errors(const std::string& path, const std::vector<double>& errors);

}  // namespace flatspeckle::apps
