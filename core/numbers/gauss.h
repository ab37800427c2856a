#pragma once

#include <vector>

namespace flatspeckle {

/// Nodes and weights of a quadrature over [0, 1]; nodes rise.
struct QuadratureRule {
  std::vector<double> node, weight;
};

/// Gauss-Legendre: exact to degree 2 n - 1.
QuadratureRule gauss_legendre(int n);
/// int_0^1 f(y) y dy, exact to degree 2 n - 1 of f (Gauss-Jacobi).
QuadratureRule gauss_jacobi(int n);

}  // namespace flatspeckle
