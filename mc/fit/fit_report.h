#pragma once

#include "mc/fit/medium_fit.h"

namespace flatspeckle::mc {

/// Values of the parameters at coordinates.
Eigen::VectorXd values_at(const FitTask& task, const Eigen::VectorXd& coordinates);

/// What follows of the parameters from their information about a point: estimates, errors, what is
/// known, what is derived.
void put_information(const FitTask& task, const Information& known,
                     const Eigen::VectorXd& coordinates, MediumFit& fit);

/// Of coordinates, as one of values.
Eigen::MatrixXd covariance_of_values(const FitTask& task, const Eigen::VectorXd& coordinates,
                                     const Eigen::MatrixXd& covariance);

/// Whether chi^2 is no more than noise makes it, to four standard deviations.
bool is_likely(double chi_squared, Eigen::Index values, Eigen::Index parameters);

}  // namespace flatspeckle::mc
