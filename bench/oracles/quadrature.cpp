#include "bench/oracles/quadrature.h"

#include <boost/math/quadrature/gauss.hpp>

namespace flatspeckle::oracles {

void GaussPanels::add(double from, double to, int panels) {
  using Rule = boost::math::quadrature::gauss<double, 10>;
  const double half = (to - from) / (2 * panels);
  for (int panel = 0; panel < panels; ++panel) {
    const double middle = from + (2 * panel + 1) * half;
    for (std::size_t i = 0; i < Rule::abscissa().size(); ++i) {
      for (const double side : {-1.0, 1.0}) {
        node.push_back(middle + side * half * Rule::abscissa()[i]);
        weight.push_back(half * Rule::weights()[i]);
      }
    }
  }
}

}  // namespace flatspeckle::oracles
