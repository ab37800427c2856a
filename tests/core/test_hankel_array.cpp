#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include <doctest/doctest.h>

#include "bench/oracles/bessel_oracle.h"
#include "core/keys/csv.h"
#include "core/numbers/bessel.h"
#include "core/numbers/hankel_array.h"

namespace flatspeckle::test_hankel_array {

namespace {

using namespace oracles;

// Both sides of the border between the pieces and of the limit of the short phase reduction, and
// doubles next to zeros of J_0 and Y_0.
const std::vector<double> special_arguments = {HankelFit::border,
                                               std::nextafter(HankelFit::border, 0),
                                               std::nextafter(HankelFit::border, 9),
                                               0x1p23,
                                               std::nextafter(0x1p23, 0),
                                               1e17,
                                               2.404825557695773,
                                               5.520078110286311,
                                               8.653727912911013,
                                               30.63460646843198,
                                               0.8935769662791675,
                                               3.957678419314858,
                                               7.086051060301773,
                                               10.22234504349642};

// Returns arguments from 1e-8 to 1e6, logarithmically spaced, and the special ones, unsorted.
std::vector<double> arguments(int count) {
  std::vector<double> x = special_arguments;
  for (int i = 1; i <= count; ++i)
    x.push_back(std::pow(10, 14 * std::fmod(i * std::numbers::phi, 1.0) - 8));
  return x;
}

struct Sets {
  Sets(std::vector<double> arguments, int order)
      : x(std::move(arguments)), re(x.size() * (order + 1)), im(re.size()) {
    hankel_sets(x, order, re.data(), im.data());
  }
  double j(int n, std::size_t i) const { return re[n * x.size() + i]; }
  double y(int n, std::size_t i) const { return im[n * x.size() + i]; }

  std::vector<double> x, re, im;
};

double relative_error(double j, double y, const BesselOracle& exact) {
  const Wide size = exact.size();
  return std::hypot(error(j, exact.j, size), error(y, exact.y, size));
}

constexpr double infinity = std::numeric_limits<double>::infinity();

}  // namespace

TEST_CASE("hankel0: agrees with 50 digits from 1e-8 to 1e6, at borders and at zeros") {
  const auto x = arguments(3000);
  std::vector<Complex> h(x.size());
  hankel0(x, h);
  for (std::size_t i = 0; i < x.size(); ++i) {
    CAPTURE(x[i]);
    const double found = relative_error(h[i].real(), h[i].imag(), bessel_oracle(0, x[i]));
    CHECK(found < 1e-15);
  }
}

TEST_CASE("hankel_sets: agree with 50 digits relative to |H_n|, and are -inf beyond double") {
  const Sets h(arguments(60), 60);
  for (std::size_t i = 0; i < h.x.size(); ++i)
    for (const int n : {0, 1, 2, 3, 5, 9, 17, 30, 45, 60}) {
      CAPTURE(h.x[i]);
      CAPTURE(n);
      const auto exact = bessel_oracle(n, h.x[i]);
      if (abs(exact.y) > std::numeric_limits<double>::max()) {
        CHECK(h.y(n, i) == -infinity);
        CHECK(h.j(n, i) == 0);
        continue;
      }
      const double found = relative_error(h.j(n, i), h.y(n, i), exact);
      CHECK(found < (1 + n / 8.0) * 1e-15);
    }
}

TEST_CASE("hankel_sets: agree with Arb") {
  const Table table = read_csv(FLATSPECKLE_DATA "/reference/bessel_arb.csv");
  const auto order = table.column("order"), j = table.column("j"), y = table.column("y");
  const auto x = table.column("x");
  const Sets h({x.begin(), x.end()}, 60);
  for (std::size_t row = 0; row < table.rows(); ++row) {
    CAPTURE(order[row]);
    CAPTURE(x[row]);
    const int n = static_cast<int>(order[row]);
    const double found = std::hypot(h.j(n, row) - j[row], h.y(n, row) - y[row]);
    CHECK(found < (1 + n / 8.0) * 1e-15 * std::hypot(j[row], y[row]));
  }
}

TEST_CASE("hankel_sets: orders of several hundred become -inf, never NaN") {
  const Sets h({1e-8, 1e-3, 0.3, 4.5, 50, 600}, 900);
  for (std::size_t i = 0; i < h.x.size(); ++i) {
    const auto slow = hankel(900, h.x[i]);
    for (int n = 0; n <= 900; ++n) {
      CAPTURE(h.x[i]);
      CAPTURE(n);
      const long double y = slow[n].imag();
      if (std::abs(y) < std::numeric_limits<double>::max())
        CHECK(std::abs(ExtendedComplex(h.j(n, i), h.y(n, i)) - slow[n]) <
              (1 + n / 8.0) * 1e-15 * std::abs(slow[n]));
      else
        CHECK((h.j(n, i) == 0 && h.y(n, i) == -infinity));
    }
  }
}

TEST_CASE("hankel0 and hankel_sets: values do not depend on other elements or the length") {
  const auto x = arguments(40);
  std::vector<Complex> all(x.size());
  hankel0(x, all);
  const Sets whole(x, 3);
  for (std::size_t size = 0; size <= x.size(); ++size) {
    CAPTURE(size);
    std::vector<Complex> some(size + 1, {7, 7});
    hankel0({x.data(), size}, {some.data(), size});
    CHECK(some[size] == Complex(7, 7));
    const Sets part({x.begin(), x.begin() + size}, 3);
    for (std::size_t i = 0; i < size; ++i) {
      CHECK(std::abs(some[i] - all[i]) <= 2e-16 * std::abs(all[i]));
      CHECK(part.y(3, i) == doctest::Approx(whole.y(3, i)).epsilon(1e-14));
    }
  }
}

TEST_CASE("hankel_sets: orders 0 and 1 agree with the first rows of order 2") {
  for (const int order : {0, 1}) {
    const Sets some(special_arguments, order), more(special_arguments, 2);
    for (std::size_t i = 0; i < some.re.size(); ++i) {
      CHECK(some.re[i] == doctest::Approx(more.re[i]).epsilon(1e-15));
      CHECK(some.im[i] == doctest::Approx(more.im[i]).epsilon(1e-15));
    }
  }
}

TEST_CASE("hankel_sets: Wronskian J_{n+1} Y_n - J_n Y_{n+1} = 2 / (pi x) up to the turning point") {
  const Sets h({0.7, 3.9, 4.1, 12, 60, 1e3, 1e6}, 60);
  for (std::size_t i = 0; i < h.x.size(); ++i)
    for (int n = 0; n < 60 && n < h.x[i]; ++n) {
      CAPTURE(h.x[i]);
      CAPTURE(n);
      const double found = h.j(n + 1, i) * h.y(n, i) - h.j(n, i) * h.y(n + 1, i);
      CHECK(found * h.x[i] * std::numbers::pi / 2 == doctest::Approx(1).epsilon(1e-13));
    }
}

}  // namespace flatspeckle::test_hankel_array
