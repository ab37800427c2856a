#include <cmath>
#include <numbers>

#include <boost/math/constants/constants.hpp>
#include <boost/math/special_functions/bessel.hpp>
#include <boost/multiprecision/cpp_bin_float.hpp>
#include <boost/multiprecision/cpp_complex.hpp>
#include <doctest/doctest.h>

#include "core/bessel.h"

namespace flatspeckle {

namespace {

using Wide = boost::multiprecision::cpp_bin_float_50;
using WideComplex = boost::multiprecision::cpp_complex_100;

struct Oracle {
  Wide j, y;
};

Oracle oracle(int n, double x) {
  return {boost::math::cyl_bessel_j(n, Wide(x)), boost::math::cyl_neumann(n, Wide(x))};
}

// |found - exact| / scale without leaving extended range
double error(long double found, const Wide& exact, const Wide& scale) {
  return static_cast<double>(abs((Wide(found) - exact) / scale));
}

// J_n(z) (n! 2^n / z^n) = sum (-z^2/4)^k n! / (k! (n+k)!); J_{n+1}/J_n = z / (2(n+1)) times a
// ratio.
WideComplex power_series(int n, const WideComplex& z) {
  WideComplex term = 1, sum = 1;
  const WideComplex step = -z * z / 4;
  for (int k = 1; k < 3000; ++k) {
    term *= step / (WideComplex(k) * (n + k));
    sum += term;
    if (abs(term) < abs(sum) * 1e-60 && k > 10) break;
  }
  return sum;
}

}  // namespace

TEST_CASE("Hankel functions agree with 50 digits from far below to far above the turning point") {
  for (const double x :
       {1e-3, 0.1, 0.7, 1.0, 2.404825557695773, 3.831705970207512, 6.2, 12.5, 31.0, 77.7, 250.0}) {
    const auto h = hankel(60, x);
    for (const int n : {0, 1, 2, 3, 5, 9, 17, 30, 31, 45, 60}) {
      CAPTURE(x);
      CAPTURE(n);
      const auto [j, y] = oracle(n, x);
      const Wide size = sqrt(j * j + y * y);
      CHECK(error(h[n].real(), j, n > x ? abs(j) : size) < 1e-14);
      CHECK(error(h[n].imag(), y, size) < 1e-14);
    }
  }
}

TEST_CASE("Orders of several hundred stay in range at small arguments") {
  for (const double x : {1e-3, 0.1, 6.28}) {
    const auto h = hankel(400, x);
    CAPTURE(x);
    const auto [j, y] = oracle(400, x);
    CHECK(error(h[400].real(), j, abs(j)) < 1e-14);
    CHECK(error(h[400].imag(), y, abs(y)) < 1e-14);
  }
}

TEST_CASE("J_n agrees with 50 digits, relative to itself away from zeros") {
  for (const double x : {1e-4, 0.5, 2.404825557695773, 5.0, 14.9, 100.0}) {
    const auto values = bessel_j(130, x);
    for (const int n : {0, 1, 2, 7, 14, 40, 99, 130}) {
      CAPTURE(x);
      CAPTURE(n);
      const auto [j, y] = oracle(n, x);
      const bool near_zero = abs(j) < 0.1 * abs(y) && n < x;
      CHECK(error(values[n], j, near_zero ? Wide(1) : abs(j)) < (near_zero ? 1e-15 : 1e-13));
    }
  }
}

TEST_CASE("Neighbouring J_n have ratios of full extended precision") {
  for (const double x : {1e-4, 0.5, 20.0}) {
    const auto values = bessel_j(30, x);
    for (const int n : {0, 3, 29}) {
      CAPTURE(x);
      CAPTURE(n);
      const Wide exact = oracle(n + 1, x).j / oracle(n, x).j;
      CHECK(error(values[n + 1] / values[n], exact, abs(exact)) < 1e-17);
    }
  }
}

TEST_CASE("Ratios of complex argument agree with the power series in 100 digits") {
  const ExtendedComplex arguments[] = {{1e-4L, 1e-5L}, {1.5L, 0.1L},  {0.1L, 5.0L},
                                       {10.0L, 0.0L},  {20.0L, 3.0L}, {30.0L, 0.01L},
                                       {10.0L, 100.0L}};
  for (const ExtendedComplex z : arguments) {
    const auto ratios = bessel_ratios(50, z);
    const WideComplex wide(Wide(z.real()), Wide(z.imag()));
    for (const int n : {0, 1, 4, 19, 50}) {
      CAPTURE(z);
      CAPTURE(n);
      const WideComplex exact =
          wide / (2 * (n + 1)) * power_series(n + 1, wide) / power_series(n, wide);
      const WideComplex found(Wide(ratios[n].real()), Wide(ratios[n].imag()));
      CHECK(static_cast<double>(abs(found - exact) / abs(exact)) < 1e-16);
    }
  }
}

TEST_CASE("Wronskian J_{n+1} Y_n - J_n Y_{n+1} = 2 / (pi x), and the two forms of the derivative") {
  for (const double x : {0.01, 1.0, 9.5, 60.0}) {
    const auto h = hankel(80, x);
    for (int n = 1; n < 80; ++n) {
      CAPTURE(x);
      CAPTURE(n);
      const long double wronskian = h[n + 1].real() * h[n].imag() - h[n].real() * h[n + 1].imag();
      CHECK(wronskian * x * std::numbers::pi / 2 == doctest::Approx(1).epsilon(1e-13));
      const ExtendedComplex symmetric = (h[n - 1] - h[n + 1]) / 2.0L;
      CHECK(std::abs(cylinder_derivative(h, n, x) - symmetric) < 1e-14 * std::abs(symmetric));
    }
  }
}

TEST_CASE("Fast H_0 agrees with 50 digits") {
  for (double x = 1e-6; x < 1e4; x *= 1.37) {
    CAPTURE(x);
    const auto [j, y] = oracle(0, x);
    const Wide size = sqrt(j * j + y * y);
    const Complex h = hankel0(x);
    CHECK(error(h.real(), j, size) < 2e-15);
    CHECK(error(h.imag(), y, size) < 2e-15);
  }
}

}  // namespace flatspeckle
