#pragma once

#include <vector>

namespace flatspeckle::oracles {

/// Nodes and weights of Gauss-Legendre quadrature. `add` appends those for [from, to], divided into
/// `panels` panels of 10 nodes.
struct GaussPanels {
  std::vector<double> node, weight;
  void add(double from, double to, int panels = 1);
};

}  // namespace flatspeckle::oracles
