#include <cmath>

#include <boost/multiprecision/cpp_complex.hpp>
#include <doctest/doctest.h>

#include "bench/oracles/bessel_oracle.h"
#include "flatland/scatterers/scatterer.h"

namespace flatspeckle::test_scatterer {

namespace {

using namespace oracles;

using WideComplex = boost::multiprecision::cpp_complex_50;
using Kind = Scatterer::Kind;

constexpr double k = 2 * std::numbers::pi;

Scatterer disk(Kind kind, double x, Complex index = 1.5) {
  Scatterer scatterer;
  scatterer.kind = kind;
  scatterer.radius = x / k;
  scatterer.index = index;
  return scatterer;
}

CrossSections cross_sections_of(const Scatterer& scatterer) {
  return cross_sections(t_matrix(scatterer, k, isolated_order(scatterer, k, 1e-15)), k);
}

// Evaluates C7 literally, for a real index.
WideComplex oracle(const Scatterer& scatterer, int n) {
  const Wide x(k * scatterer.radius), m(scatterer.index.real());
  const auto [j, y] = bessel_oracle(n, x);
  const auto [derivative_j, derivative_y] = bessel_prime_oracle(n, x);
  const WideComplex h(j, y), derivative_h(derivative_j, derivative_y);
  if (scatterer.kind == Kind::soft) return -j / h;
  if (scatterer.kind == Kind::hard) return -derivative_j / derivative_h;
  const Wide q = scatterer.kind == Kind::tm ? m : 1 / m;
  const Wide inside = bessel_oracle(n, m * x).j;
  const Wide derivative_inside = q * bessel_prime_oracle(n, m * x).j;
  return -(derivative_inside * j - inside * derivative_j) /
         (derivative_inside * h - inside * derivative_h);
}

double relative_error(ExtendedComplex found, const WideComplex& exact) {
  const WideComplex wide(Wide(found.real()), Wide(found.imag()));
  return static_cast<double>(abs(wide - exact) / abs(exact));
}

}  // namespace

TEST_CASE("T_n: agrees with C7 in 50 digits") {
  for (const Kind kind : {Kind::soft, Kind::hard, Kind::tm, Kind::te})
    for (const double x : {1e-4, 0.01, 0.3, 1.0, 7.3, 40.0})
      for (const double index : {1.5, 0.7, 10.0}) {
        const Scatterer scatterer = disk(kind, x, index);
        const auto t = t_matrix(scatterer, k, 60);
        for (const int n : {0, 1, 2, 5, 12, 33, 60}) {
          CAPTURE(static_cast<int>(kind));
          CAPTURE(x);
          CAPTURE(index);
          CAPTURE(n);
          CHECK(relative_error(t[n], oracle(scatterer, n)) < 1e-12);
        }
      }
}

TEST_CASE("T_n: accurate for index contrasts of 1e-8, 0 for index 1") {
  for (const Kind kind : {Kind::tm, Kind::te})
    for (const double x : {1e-3, 1.0, 20.0}) {
      const Scatterer faint = disk(kind, x, 1 + 1e-8);
      const auto t = t_matrix(faint, k, 8);
      for (const int n : {0, 1, 4, 8}) {
        CAPTURE(x);
        CAPTURE(n);
        CHECK(relative_error(t[n], oracle(faint, n)) < 1e-9);
      }
    }
  const auto nothing = t_matrix(disk(Kind::tm, 3, 1.0), k, 5);
  for (const auto& t_n : nothing) CHECK(t_n == ExtendedComplex(0));
  CHECK(cross_sections(nothing, k).g == 0);
}

TEST_CASE("T_n: |1 + 2 T_n| = 1 for lossless scatterers") {
  for (const Kind kind : {Kind::soft, Kind::hard, Kind::tm, Kind::te})
    for (const double x : {1e-4, 0.5, 3.0, 100.0})
      for (const auto& t_n : t_matrix(disk(kind, x, 10.0), k, static_cast<int>(x) + 10))
        CHECK(static_cast<double>(std::abs(1.0L + 2.0L * t_n)) ==
              doctest::Approx(1).epsilon(1e-14));
}

TEST_CASE("cross sections: agree with known values of single cylinders") {
  const auto close = [](double value) { return doctest::Approx(value).epsilon(2e-5); };
  const auto small = cross_sections_of(disk(Kind::tm, 2, 1.33));
  CHECK(small.scattering == close(0.83228));
  CHECK(small.g == close(0.74215));
  const auto large = cross_sections_of(disk(Kind::tm, 5, 1.33));
  CHECK(large.scattering == close(6.12763));
  CHECK(large.g == close(0.90488));
  const auto absorbing = cross_sections_of(disk(Kind::tm, 5, {1.33, 0.01}));
  CHECK(absorbing.scattering == close(5.59612));
  CHECK(absorbing.extinction == close(5.90421));
  CHECK(absorbing.scattering / absorbing.extinction == close(0.94782));
  const auto box_cylinder = cross_sections_of(disk(Kind::tm, 1, 1.5));
  CHECK(box_cylinder.scattering == close(0.30014));
  CHECK(box_cylinder.g == doctest::Approx(0.3202).epsilon(2e-4));
  const auto faint = cross_sections_of(disk(Kind::tm, 1, 1.2));
  CHECK(faint.scattering == close(0.048653));
}

TEST_CASE("T_n: a small TE cylinder agrees with its dipole") {
  const double x = 1e-3, m2 = 2.25;
  const auto t = t_matrix(disk(Kind::te, x), k, 1);
  const double dipole = std::numbers::pi * x * x / 4 * (m2 - 1) / (m2 + 1);
  CHECK(static_cast<double>(t[1].imag()) == doctest::Approx(dipole).epsilon(1e-5));
}

TEST_CASE("cross sections and g: agree with integrals of the amplitude") {
  const Scatterer cylinder = disk(Kind::te, 3, {1.4, 0.2});
  const auto t = t_matrix(cylinder, k, isolated_order(cylinder, k, 1e-15));
  const auto sections = cross_sections(t, k);
  double scattered = 0, cosine = 0;
  constexpr int angles = 64;
  for (int i = 0; i < angles; ++i) {
    const double theta = 2 * std::numbers::pi * i / angles;
    const double power = std::norm(amplitude(t, k, theta)) * 2 * std::numbers::pi / angles;
    scattered += power;
    cosine += power * std::cos(theta);
  }
  CHECK(sections.scattering == doctest::Approx(scattered).epsilon(1e-13));
  CHECK(sections.g == doctest::Approx(cosine / scattered).epsilon(1e-13));
  const Complex forward = std::polar(1.0, std::numbers::pi / 4) * amplitude(t, k, 0);
  CHECK(sections.extinction ==
        doctest::Approx(-std::sqrt(8 * std::numbers::pi / k) * forward.real()).epsilon(1e-13));
  CHECK(sections.extinction > sections.scattering);
}

TEST_CASE("cross sections: scattering of lossless cylinders never exceeds extinction by rounding") {
  for (const Kind kind : {Kind::tm, Kind::te})
    for (const double radius : {0.05, 0.1, 0.25, 0.4, 1.0})
      for (const double index : {1.1, 1.2, 1.33, 1.4, 1.5, 1.6, 2.0, 3.0}) {
        const Scatterer cylinder{.kind = kind, .radius = radius, .index = index};
        const auto sections =
            cross_sections(t_matrix(cylinder, k, isolated_order(cylinder, k, 1e-13)), k);
        CAPTURE(radius);
        CAPTURE(index);
        CHECK(sections.scattering <= sections.extinction);
        CHECK(sections.scattering == doctest::Approx(sections.extinction).epsilon(1e-14));
      }
}

TEST_CASE("cross sections: point scatterers") {
  Scatterer point;
  const auto resonant = cross_sections(t_matrix(point, k, 0), k);
  CHECK(resonant.scattering == doctest::Approx(4 / k).epsilon(1e-15));
  CHECK(resonant.g == 0);
  point.albedo = 0.8;
  const auto absorbing = cross_sections(t_matrix(point, k, 0), k);
  CHECK(absorbing.scattering == doctest::Approx(4 * 0.64 / k).epsilon(1e-15));
  CHECK(absorbing.extinction == doctest::Approx(4 * 0.8 / k).epsilon(1e-15));
  point.albedo = 1;
  point.phase_shift = 0.3;
  const auto t = t_matrix(point, k, 2);
  const Complex expected = -(1.0 - std::polar(1.0, 0.6)) / 2.0;
  CHECK(std::abs(Complex(t[0]) - expected) < 1e-16);
  CHECK(t[1] == ExtendedComplex(0));
  CHECK(isolated_order(point, k, 1e-15) == 0);
}

TEST_CASE("isolated order: the smallest order whose omitted T_n are below the tolerance") {
  for (const Kind kind : {Kind::soft, Kind::hard, Kind::tm, Kind::te})
    for (const double x : {1e-3, 1.0, 30.0})
      for (const double tolerance : {1e-3, 1e-12}) {
        const Scatterer scatterer = disk(kind, x, 10.0);
        const int order = isolated_order(scatterer, k, tolerance);
        const auto t = t_matrix(scatterer, k, order + 400);
        long double largest = 0, left_out = 0;
        for (const auto& t_n : t) largest = std::max(largest, std::abs(t_n));
        for (std::size_t n = order + 1; n < t.size(); ++n)
          left_out = std::max(left_out, std::abs(t[n]));
        CHECK(left_out <= tolerance * largest);
        CHECK(std::abs(t[order]) > tolerance * largest);
      }
}

}  // namespace flatspeckle::test_scatterer
