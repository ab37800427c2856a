#include "bench/oracles/bessel_oracle.h"

#include <boost/math/special_functions/bessel.hpp>

namespace flatspeckle::oracles {

Wide BesselOracle::size() const {
  return sqrt(j * j + y * y);
}

BesselOracle bessel_oracle(int n, const Wide& x) {
  return {boost::math::cyl_bessel_j(n, x), boost::math::cyl_neumann(n, x)};
}

BesselOracle bessel_prime_oracle(int n, const Wide& x) {
  const BesselOracle here = bessel_oracle(n, x), next = bessel_oracle(n + 1, x);
  return {n / x * here.j - next.j, n / x * here.y - next.y};  // DLMF 10.6.2
}

double error(long double found, const Wide& exact, const Wide& scale) {
  return static_cast<double>(abs((Wide(found) - exact) / scale));
}

}  // namespace flatspeckle::oracles
