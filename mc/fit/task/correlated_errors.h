#pragma once

#include <Eigen/Core>

#include "core/numbers/statistics.h"

namespace flatspeckle::mc {

/// Of what an estimator makes of sums, real parts, [value][group]: the product with its transpose
/// is the covariance of the errors, by leaving one group out at a time as jackknife() does.
Eigen::MatrixXd deviations(const GroupedSums& sums, const Estimator& theta);

/// The covariance of the errors of what an estimator makes of sums, real parts, by leaving one
/// group out at a time as jackknife() does; its inverse is that of Hartlap, Simon and Schneider
/// 2007 (eq. 17), for so many groups and values. Shrunk towards its diagonal (Ledoit and Wolf 2004)
/// by 1/groups: sums of values whose errors all but cancel rest on a few strong paths, and on the
/// rounding of models. Empty where groups are fewer than values and ten.
Eigen::MatrixXd correlated_errors(const GroupedSums& sums, const Estimator& theta);

}  // namespace flatspeckle::mc
