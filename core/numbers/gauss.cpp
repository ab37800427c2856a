#include "core/numbers/gauss.h"

#include <cmath>

#include "core/numbers/symmetric.h"

namespace flatspeckle {

namespace {

/// Returns the Gauss rule with n nodes for the weight function (1 + x)^beta on [-1, 1] (Golub and
/// Welsch 1969), with the nodes mapped to [0, 1]. total: sum of the weights of the mapped rule.
QuadratureRule gauss(int n, double beta, double total) {
  Eigen::VectorXd diagonal(n), beside(std::max(n - 1, 1));
  for (int j = 0; j < n; ++j) {
    const double a = 2 * j + beta;
    diagonal[j] = j == 0 ? beta / (beta + 2) : beta * beta / (a * (a + 2));
    const double i = j + 1, s = 2 * i + beta;
    if (j + 1 < n)
      beside[j] = std::sqrt(4 * i * i * (i + beta) * (i + beta) / (s * s * (s * s - 1)));
  }
  const SymmetricEigen eigen = tridiagonal_eigen(diagonal, beside.head(n - 1));
  QuadratureRule rule;
  for (int j = 0; j < n; ++j) {
    const double first = eigen.vectors(0, j);
    rule.node.push_back((1 + eigen.values[j]) / 2);
    rule.weight.push_back(total * first * first);
  }
  return rule;
}

}  // namespace

QuadratureRule gauss_legendre(int n) {
  return gauss(n, 0, 1);
}

QuadratureRule gauss_jacobi(int n) {
  return gauss(n, 1, 0.5);
}

}  // namespace flatspeckle
