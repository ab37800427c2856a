#pragma once

#include <boost/multiprecision/cpp_bin_float.hpp>

namespace flatspeckle::oracles {

using Wide = boost::multiprecision::cpp_bin_float_50;

/// The values J_n(x) and Y_n(x) in 50 digits.
struct BesselOracle {
  Wide j, y;

  Wide size() const;
};

BesselOracle bessel_oracle(int n, const Wide& x);
/// J_n'(x) and Y_n'(x).
BesselOracle bessel_prime_oracle(int n, const Wide& x);

/// Returns |found - exact| / scale, computed in extended range, without overflow.
double error(long double found, const Wide& exact, const Wide& scale);

}  // namespace flatspeckle::oracles
