#include <cmath>
#include <numbers>

#include <boost/math/quadrature/gauss_kronrod.hpp>
#include <doctest/doctest.h>

#include "flatland/media/hard_sphere_fluid.h"
#include "flatland/media/medium.h"
#include "flatland/media/structure_factor.h"

namespace flatspeckle::test_correlated_medium {

namespace {

constexpr double pi = std::numbers::pi, k = 2 * pi;

Scatterer cylinder(double ka, Complex index, double wavenumber = k) {
  return {.kind = Scatterer::Kind::tm, .radius = ka / wavenumber, .index = index};
}

/// Returns the spacing of disks without extra gap at a packing fraction.
DiskSpacing spacing(const Scatterer& disk, double packing) {
  return {packing / (pi * disk.radius * disk.radius), 2 * disk.radius};
}

BulkMedium correlated(const Scatterer& disk, double packing, double wavenumber = k) {
  const DiskSpacing disks = spacing(disk, packing);
  return correlated_medium(bulk_medium(disk, wavenumber, disks.density), wavenumber,
                           hard_disk_structure(disks, 2 * wavenumber));
}

/// Integrates f(theta) |A|^2 S over the circle with A and S from their formulas.
template <typename Weight>
double integral(const Scatterer& disk, double packing, Weight f) {
  const DiskSpacing disks = spacing(disk, packing);
  const HardDiskFluid fluid(packing, disks.contact);
  const auto t = bulk_medium(disk, k, 1).t_matrix;
  const auto integrand = [&](double theta) {
    return f(theta) * std::norm(amplitude(t, k, theta)) *
           fluid.structure_factor(2 * k * std::sin(theta / 2));
  };
  return 2 *
         boost::math::quadrature::gauss_kronrod<double, 61>::integrate(integrand, 0.0, pi, 8, 1e-9);
}

}  // namespace

TEST_CASE("structure table: linear between its nodes, constant before and 1 after them") {
  const StructureFactor none, table("made up", {1, 2, 4}, {0.5, 0.7, 0.3});
  CHECK(none.independent());
  CHECK(none(3) == 1);
  CHECK_FALSE(table.independent());
  for (const auto& [q, s] : {std::pair{0.0, 0.5},
                             {0.7, 0.5},
                             {1.0, 0.5},
                             {1.5, 0.6},
                             {2.0, 0.7},
                             {3.5, 0.4},
                             {4.0, 0.3},
                             {4.01, 1.0},
                             {100.0, 1.0}})
    CHECK(table(q) == doctest::Approx(s).epsilon(1e-14));
}

TEST_CASE("structure table of hard disks: agrees with the fluid") {
  const DiskSpacing disks{0.3 / (pi * 0.25), 1};
  CHECK(disks.packing() == doctest::Approx(0.3).epsilon(1e-14));
  const StructureFactor table = hard_disk_structure(disks, 40);
  const HardDiskFluid fluid(0.3, 1);
  for (double q = 0; q <= 40; q += 0.137)
    CHECK(std::abs(table(q) - fluid.structure_factor(q)) < 2e-4);
}

TEST_CASE("correlated medium: S = 1 does not change the medium") {
  for (const Complex index : {Complex(1.5), Complex(1.33, 0.05)}) {
    const BulkMedium plain = bulk_medium(cylinder(5, index), k, 0.2);
    const BulkMedium same = correlated_medium(plain, k, StructureFactor("one", {0, 1}, {1, 1}));
    CHECK(same.mu_s == doctest::Approx(plain.mu_s).epsilon(1e-14));
    CHECK(same.mu_t == doctest::Approx(plain.mu_t).epsilon(1e-14));
    CHECK(same.g == doctest::Approx(plain.g).epsilon(1e-14));
    CHECK(same.albedo == doctest::Approx(plain.albedo).epsilon(1e-14));
    const auto values = normalised_amplitudes(same, k, 10);
    const auto expected = normalised_amplitudes(plain, k, 10);
    for (std::size_t i = 0; i <= 10; ++i)
      CHECK(std::abs(values[i] - expected[i]) < 1e-14 * std::abs(expected[0]));
  }
}

TEST_CASE("correlated medium: mu_s, g and albedo agree with quadrature") {
  for (const double ka : {0.3, 1.0, 5.0}) {
    const Scatterer disk = cylinder(ka, {1.3, 0.02});
    const double packing = 0.2;
    const BulkMedium plain = bulk_medium(disk, k, spacing(disk, packing).density);
    const BulkMedium medium = correlated(disk, packing);
    const double sigma = integral(disk, packing, [](double) { return 1; });
    const double cosine = integral(disk, packing, [](double theta) { return std::cos(theta); });
    CHECK(medium.mu_s == doctest::Approx(plain.density * sigma).epsilon(1e-4));
    CHECK(medium.g == doctest::Approx(cosine / sigma).epsilon(3e-4));
    // Absorption does not depend on correlations of positions.
    CHECK(medium.mu_t - medium.mu_s == doctest::Approx(plain.mu_t - plain.mu_s).epsilon(1e-12));
    CHECK(medium.albedo == doctest::Approx(medium.mu_s / medium.mu_t).epsilon(1e-14));
    CHECK(medium.density == plain.density);
    CHECK(medium.k_shift == plain.k_shift);
    CHECK(medium.mu_s < 0.95 * plain.mu_s);
  }
}

TEST_CASE("correlated medium: small disks scatter S(0) times as much, without loss") {
  const Scatterer disk = cylinder(0.01, 1.5);
  const double packing = 0.3;
  const BulkMedium medium = correlated(disk, packing);
  CHECK(medium.mu_s / (medium.density * medium.cross_sections.scattering) ==
        doctest::Approx(HardDiskFluid(packing, 1).structure_factor(0)).epsilon(2e-3));
  CHECK(medium.albedo == doctest::Approx(1).epsilon(1e-12));
}

TEST_CASE("correlated medium: amplitudes have the square root of S and the phase of A") {
  const Scatterer disk = cylinder(2, 1.4);
  const BulkMedium medium = correlated(disk, 0.25);
  const HardDiskFluid fluid(0.25, 2 * disk.radius);
  const auto values = normalised_amplitudes(medium, k, 10);
  const double scale = std::sqrt(medium.density / medium.mu_s);
  for (std::size_t i = 0; i <= 10; i += 2) {
    const double theta = pi * static_cast<double>(i) / 10;
    const Complex ratio = values[i] / (scale * amplitude(medium.t_matrix, k, theta));
    CHECK(ratio.real() * ratio.real() ==
          doctest::Approx(fluid.structure_factor(2 * k * std::abs(std::sin(theta / 2))))
              .epsilon(1e-3));
    CHECK(std::abs(ratio.imag()) < 1e-14);
  }
}

/// Returns A(theta) sqrt(S).
Complex scattering_amplitude(const BulkMedium& medium, double theta) {
  return std::sqrt(medium.structure(2 * k * std::abs(std::sin(theta / 2)))) *
         amplitude(medium.t_matrix, k, theta);
}

TEST_CASE("normalised amplitudes: agree with single angles") {
  for (const double ka : {0.05, 1.0, 30.0}) {
    const BulkMedium medium = correlated(cylinder(ka, {1.33, 0.01}), 0.2);
    const std::size_t intervals = 1000;
    const auto values = normalised_amplitudes(medium, k, intervals);
    REQUIRE(values.size() == intervals + 1);
    const double scale = std::sqrt(medium.density / medium.mu_s);
    double phase_function = 0;
    for (std::size_t i = 0; i <= intervals; ++i) {
      const double theta = pi * static_cast<double>(i) / intervals;
      CHECK(std::abs(values[i] - scale * scattering_amplitude(medium, theta)) <
            1e-11 * std::abs(values[0]));
      phase_function += (i % intervals == 0 ? 1 : 2) * std::norm(values[i]) * pi / intervals;
    }
    CHECK(phase_function == doctest::Approx(1).epsilon(1e-3));
  }
}

TEST_CASE("correlated medium: independent of the unit of length") {
  const BulkMedium one = correlated(cylinder(1, 1.3), 0.2);
  const BulkMedium other = correlated(cylinder(1, 1.3, k / 7), 0.2, k / 7);
  CHECK(other.g == doctest::Approx(one.g).epsilon(1e-12));
  CHECK(7 * other.mu_t == doctest::Approx(one.mu_t).epsilon(1e-12));
}

// Small spheres scatter at q -> 0, where S has its closed form; absorption does not depend on S.
TEST_CASE("correlated spheres: small ones scatter S(0) times as much, large ones in a ring") {
  const Scatterer small{.kind = Scatterer::Kind::tm, .radius = 1e-3, .index = {1.5, 0.01}};
  const double packing = 0.3, density = packing / small.content(3);
  const BulkMedium alone = bulk_medium(small, k, density, 3),
                   fluid = correlated_medium(alone, k, hard_sphere_structure(density, 2e-3));
  const double expected = std::pow(1 - packing, 4) / std::pow(1 + 2 * packing, 2);
  CHECK(fluid.mu_s / alone.mu_s == doctest::Approx(expected).epsilon(1e-4));
  CHECK(fluid.mu_t - fluid.mu_s == doctest::Approx(alone.mu_t - alone.mu_s).epsilon(1e-12));

  const Scatterer large{.kind = Scatterer::Kind::hard, .radius = 0.4};
  const double number = 0.2 / large.content(3);
  const BulkMedium ring =
      correlated_medium(bulk_medium(large, k, number, 3), k, hard_sphere_structure(number, 0.8));
  const HardSphereFluid spheres(0.2, 0.8);
  const auto integrand = [&](double cosine) {
    return 2 * pi * std::norm(amplitude_in_space(ring.t_matrix, k, cosine)) *
           spheres.structure_factor(k * std::sqrt(2 - 2 * cosine));
  };
  using Rule = boost::math::quadrature::gauss_kronrod<double, 61>;
  CHECK(ring.mu_s == doctest::Approx(number * Rule::integrate(integrand, -1, 1, 5)).epsilon(1e-9));
  const auto amplitudes = correlated_amplitudes_in_space(ring, k);
  CHECK(std::norm(amplitudes.front()) == doctest::Approx(integrand(1) / (2 * pi)).epsilon(1e-12));
}

}  // namespace flatspeckle::test_correlated_medium
