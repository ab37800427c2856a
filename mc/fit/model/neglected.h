#pragma once

#include <Eigen/Core>

#include "mc/fit/task/curve_values.h"
#include "mc/fit/task/fit_task.h"

namespace flatspeckle::mc {

/// Covariance of what paths neglect of waves in values of all curves, as the documented bias has it
/// (Allowance). Of an intensity it is a share: that of crossed paths, refraction and correlated
/// positions the same in all views; that of near zones and of a box that guides alike in views that
/// are nearer to each other than 1/(k a). Of a correlation C it is that share of 1 - C, in all
/// alike. 0 of power, of media that are but a phase function, and of measurements that paths have
/// made themselves.
Eigen::MatrixXd neglected_covariance(const FitTask& task, const Media& media,
                                     const Eigen::VectorXd& values);

}  // namespace flatspeckle::mc
