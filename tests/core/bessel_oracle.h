#pragma once

#include <boost/math/constants/constants.hpp>
#include <boost/math/special_functions/bessel.hpp>
#include <boost/multiprecision/cpp_bin_float.hpp>

namespace flatspeckle {

using Wide = boost::multiprecision::cpp_bin_float_50;

/// J_n(x) and Y_n(x) in 50 digits.
struct BesselOracle {
  Wide j, y;

  Wide size() const { return sqrt(j * j + y * y); }
};

inline BesselOracle bessel_oracle(int n, double x) {
  return {boost::math::cyl_bessel_j(n, Wide(x)), boost::math::cyl_neumann(n, Wide(x))};
}

/// |found - exact| / scale without leaving extended range
inline double error(long double found, const Wide& exact, const Wide& scale) {
  return static_cast<double>(abs((Wide(found) - exact) / scale));
}

}  // namespace flatspeckle
