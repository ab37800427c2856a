#include <cmath>
#include <numbers>
#include <string>

#include <boost/multiprecision/cpp_complex.hpp>
#include <doctest/doctest.h>

#include "bench/oracles/bessel_oracle.h"
#include "core/keys/csv.h"
#include "core/numbers/bessel.h"

namespace flatspeckle::test_bessel {

namespace {

using namespace oracles;

using WideComplex = boost::multiprecision::cpp_complex_100;

// Returns J_n(z) (n! 2^n / z^n) = sum (-z^2/4)^k n! / (k! (n+k)!); J_{n+1}/J_n is z / (2(n+1))
// times a ratio of these.
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

TEST_CASE("Hankel functions: agree with 50 digits far below and above the turning point") {
  for (const double x : {1e-8, 1e-3, 0.1, 0.7, 1.0, 2.404825557695773, 3.831705970207512, 6.2, 12.5,
                         31.0, 77.7, 250.0, 4e3, 1e6}) {
    const auto h = hankel(60, x);
    for (const int n : {0, 1, 2, 3, 5, 9, 17, 30, 31, 45, 60}) {
      CAPTURE(x);
      CAPTURE(n);
      const auto [j, y] = bessel_oracle(n, x);
      const Wide size = BesselOracle{j, y}.size();
      CHECK(error(h[n].real(), j, n > x ? abs(j) : size) < 1e-14);
      CHECK(error(h[n].imag(), y, size) < 1e-14);
    }
  }
}

TEST_CASE("Hankel functions: order 400 agrees with 50 digits at small arguments") {
  for (const double x : {1e-3, 0.1, 6.28}) {
    const auto h = hankel(400, x);
    CAPTURE(x);
    const auto [j, y] = bessel_oracle(400, x);
    CHECK(error(h[400].real(), j, abs(j)) < 1e-14);
    CHECK(error(h[400].imag(), y, abs(y)) < 1e-14);
  }
}

TEST_CASE("J_n: agrees with 50 digits, relative to itself away from zeros") {
  for (const double x : {1e-4, 0.5, 2.404825557695773, 5.0, 14.9, 100.0}) {
    const auto values = bessel_j(130, x);
    for (const int n : {0, 1, 2, 7, 14, 40, 99, 130}) {
      CAPTURE(x);
      CAPTURE(n);
      const auto [j, y] = bessel_oracle(n, x);
      const bool near_zero = abs(j) < 0.1 * abs(y) && n < x;
      CHECK(error(values[n], j, near_zero ? Wide(1) : abs(j)) < (near_zero ? 1e-15 : 1e-13));
    }
  }
}

TEST_CASE("J_n: ratios of neighbouring orders have full extended precision") {
  for (const double x : {1e-4, 0.5, 20.0}) {
    const auto values = bessel_j(30, x);
    for (const int n : {0, 3, 29}) {
      CAPTURE(x);
      CAPTURE(n);
      const Wide exact = bessel_oracle(n + 1, x).j / bessel_oracle(n, x).j;
      CHECK(error(values[n + 1] / values[n], exact, abs(exact)) < 1e-17);
    }
  }
}

TEST_CASE("Bessel ratios: complex arguments agree with the power series in 100 digits") {
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

TEST_CASE("Hankel functions: Wronskian 2 / (pi x), and the two forms of the derivative") {
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

TEST_CASE("H_n and J_n: agree with Arb from 1e-8 to 1e6") {
  const Table table = read_csv(FLATSPECKLE_DATA "/reference/bessel_arb.csv");
  const auto order = table.column("order"), x = table.column("x"), j = table.column("j"),
             y = table.column("y");
  for (std::size_t row = 0; row < table.rows(); ++row) {
    CAPTURE(order[row]);
    CAPTURE(x[row]);
    const int n = static_cast<int>(order[row]);
    const double size = std::hypot(j[row], y[row]);
    const ExtendedComplex h = hankel(n, x[row])[n];
    CHECK(std::abs(h - ExtendedComplex(j[row], y[row])) < 1e-14 * size);
    const double j_size = n > x[row] ? std::abs(j[row]) : size;
    CHECK(std::abs(h.real() - j[row]) < 1e-14 * j_size);
    CHECK(std::abs(bessel_j(n, x[row])[n] - j[row]) < 1e-14 * j_size);
  }
}

TEST_CASE("J_{n+1} / J_n and J_n' / J_n: complex arguments agree with Arb") {
  const Table table = read_csv(FLATSPECKLE_DATA "/reference/bessel_ratio_arb.csv");
  const auto value = [&](const char* name, std::size_t row) {
    return ExtendedComplex(table.column(name + std::string("_re"))[row],
                           table.column(name + std::string("_im"))[row]);
  };
  for (std::size_t row = 0; row < table.rows(); ++row) {
    const int n = static_cast<int>(table.column("order")[row]);
    const ExtendedComplex z = value("z", row), ratio = value("ratio", row);
    CAPTURE(n);
    CAPTURE(z);
    const ExtendedComplex found = bessel_ratios(n, z)[n];
    const ExtendedComplex derivative = static_cast<long double>(n) / z - found;
    const long double error = 1.1e-19L * std::abs(z) * (1 + std::norm(found));
    constexpr long double rounding = 1.2e-16L;  // of the table
    CHECK(std::abs(found - ratio) < error + rounding * std::abs(ratio));
    CHECK(std::abs(derivative - value("slope", row)) < error + rounding * std::abs(derivative));
  }
}

}  // namespace flatspeckle::test_bessel
