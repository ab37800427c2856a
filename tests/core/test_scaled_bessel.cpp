#include <cmath>
#include <numbers>

#include <doctest/doctest.h>

#include "core/numbers/bessel.h"

namespace flatspeckle::test_scaled_bessel {

TEST_CASE("scaled cylinder functions: agree with the unscaled ones in their range") {
  for (const double x : {0.01, 1.0, 2.4, 30.0}) {
    const auto h = hankel(60, x);
    const auto j = bessel_j(60, x);
    const auto scaled_h = scaled_hankel(60, x);
    const auto scaled_j = scaled_bessel_j(60, x);
    for (int n = 0; n <= 60; ++n) {
      CHECK(std::abs(static_cast<ExtendedComplex>(scaled_h[n]) - h[n]) < 1e-16L * std::abs(h[n]));
      CHECK(std::abs(static_cast<long double>(scaled_j[n]) / j[n] - 1) < 1e-15L);
    }
  }
}

TEST_CASE("scaled cylinder functions: Wronskian far beyond the range of long double") {
  const int order = 6000;
  for (const double x : {1e-4, 1.0, 100.0}) {
    const auto h = scaled_hankel(order, x);
    const auto j = scaled_bessel_j(order, x);
    CHECK(log2(abs(h[order])) > 20000);  // long double ends at 2^16384
    for (int n = 0; n < order; n += 7) {
      // J_{n+1} H_n - J_n H_{n+1} = 2i / (pi x)   (DLMF 10.5.2)
      const auto wronskian = static_cast<ExtendedComplex>(j[n + 1] * h[n] - j[n] * h[n + 1]);
      const long double expected = 2 / (std::numbers::pi_v<long double> * x);
      CHECK(std::abs(wronskian - ExtendedComplex(0, expected)) < 1e-14L * expected);
    }
  }
}

TEST_CASE("scaled numbers: sums, products and square roots") {
  const ScaledReal huge(3, 30000), small(0x1p-5000L), one = 1;
  CHECK(static_cast<long double>(huge * ScaledReal(0.5L, -30000)) == 1.5L);
  CHECK(static_cast<long double>(huge + -huge) == 0);
  CHECK(static_cast<long double>((huge + one) / huge) == 1);
  CHECK(static_cast<long double>(small * small / small) == 0x1p-5000L);
  CHECK(log2(sqrt(huge * huge)) == doctest::Approx(30000 + std::log2(3)));
  CHECK(static_cast<long double>(huge) == INFINITY);
}

}  // namespace flatspeckle::test_scaled_bessel
