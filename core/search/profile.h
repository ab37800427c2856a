#pragma once

#include "core/search/levenberg_marquardt.h"

namespace flatspeckle {

/// Returns an end of the confidence interval of parameter i by the profile likelihood: parameters
/// at which chi^2, minimised over all other parameters, exceeds that of the fit by `rise`. side: 1
/// for the upper end, -1 for the lower one. The end is at a bound if chi^2 rises by less up to
/// there. Where chi^2 is quadratic to within 40 %, the end follows from the Fisher information.
Eigen::VectorXd profile_end(const BoundedLeastSquares& problem, const LeastSquaresFit& fit,
                            Eigen::Index i, double side, double rise);

}  // namespace flatspeckle
