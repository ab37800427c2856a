#pragma once

#include <vector>

namespace flatspeckle {

/// Nodes (in increasing order) and weights of a quadrature rule over [0, 1].
struct QuadratureRule {
  std::vector<double> node, weight;
};

/// Returns the Gauss-Legendre rule with n nodes, exact for polynomials of degree up to 2 n - 1.
QuadratureRule gauss_legendre(int n);
/// Returns the Gauss-Jacobi rule with n nodes for the integral of f(y) y over [0, 1], exact for
/// polynomials f of degree up to 2 n - 1.
QuadratureRule gauss_jacobi(int n);

}  // namespace flatspeckle
