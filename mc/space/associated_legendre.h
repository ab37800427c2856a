#pragma once

#include "core/algebra/dense.h"

namespace flatspeckle::mc {

/// Associated Legendre functions of cos(angle), l = m .. last, [angle][l - m], with
/// int P_l^m(c)^2 dc = 1 over [-1, 1] and positive in the forward direction.
Matrix associated_legendre(const Eigen::VectorXd& angle, int m, int last);

}  // namespace flatspeckle::mc
