#include <cmath>

#include <doctest/doctest.h>

#include "core/keys/csv.h"
#include "core/numbers/bessel.h"
#include "flatland/scatterers/scatterer.h"

namespace flatspeckle::test_sphere {

namespace {

using Kind = Scatterer::Kind;

constexpr double k = 2 * std::numbers::pi;

std::vector<ExtendedComplex> sphere_t_matrix(Kind kind, double x, Complex index, int order) {
  Scatterer sphere{.kind = kind};
  sphere.radius = x / k;
  sphere.index = index;
  return t_matrix(sphere, k, order, Radial::spherical);
}

}  // namespace

TEST_CASE("spheres: T-matrix agrees with values in 40 digits") {
  constexpr Kind kinds[] = {Kind::soft, Kind::hard, Kind::tm};
  const Table table = read_csv(FLATSPECKLE_DATA "/reference/space/sphere_t_matrix.csv");
  for (std::size_t row = 0; row < table.rows(); ++row) {
    const auto value = [&](const char* name) { return table.column(name)[row]; };
    const auto order = static_cast<int>(value("l"));
    const auto t = sphere_t_matrix(kinds[static_cast<std::size_t>(value("kind"))], value("x"),
                                   {value("index_re"), value("index_im")}, order);
    const Complex expected(value("t_re"), value("t_im"));
    CAPTURE(row);
    CHECK(std::abs(Complex(t.back()) - expected) < 4e-14 * std::abs(expected));
  }
}

TEST_CASE(
    "spheres: lossless spheres and points obey the optical theorem, absorbing ones lose power") {
  for (const double x : {0.01, 1.0, 30.0})
    for (const Complex index : {Complex(1.5), Complex(1.5, 0.1)}) {
      const auto order = static_cast<int>(2 * x) + 15;
      const auto t = sphere_t_matrix(Kind::tm, x, index, order);
      const CrossSections found = cross_sections_in_space(t, k);
      const double forward = 4 * std::numbers::pi / k * amplitude_in_space(t, k, 1).imag();
      CHECK(forward == doctest::Approx(found.extinction).epsilon(1e-12));
      if (index.imag() == 0)
        CHECK(found.scattering == doctest::Approx(found.extinction).epsilon(1e-12));
      else
        CHECK(found.scattering < 0.99 * found.extinction);
    }
  const auto resonant = cross_sections_in_space({-1.0L}, k);
  CHECK(resonant.scattering == doctest::Approx(1 / std::numbers::pi).epsilon(1e-14));  // C57
}

TEST_CASE("spherical Bessel functions agree with the library and with the Wronskian") {
  for (const double x : {1e-3, 0.5, 7.3, 60.0}) {
    constexpr int order = 40;
    const auto j = bessel_j(order, x, Radial::spherical);
    const auto h = hankel(order, x, Radial::spherical);
    for (int n = 0; n < order; ++n) {
      CHECK(static_cast<double>(j[n]) ==
            doctest::Approx(std::sph_bessel(static_cast<unsigned>(n), x)).epsilon(1e-11));
      const long double wronskian = j[n + 1] * h[n].imag() - j[n] * h[n + 1].imag();
      CHECK(static_cast<double>(wronskian * x * x) == doctest::Approx(1).epsilon(1e-13));
    }
  }
}

}  // namespace flatspeckle::test_sphere
