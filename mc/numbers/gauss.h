#pragma once

#include <vector>

namespace flatspeckle::mc {

/// Nodes and weights of a quadrature over [0, 1]; nodes rise.
struct Quadrature {
  std::vector<double> node, weight;
};

/// Gauss-Legendre: exact to degree 2 n - 1.
Quadrature gauss_legendre(int n);
/// int_0^1 f(y) y dy, exact to degree 2 n - 1 of f (Gauss-Jacobi).
Quadrature gauss_jacobi(int n);

}  // namespace flatspeckle::mc
