#include <algorithm>
#include <cmath>
#include <stdexcept>

#include <doctest/doctest.h>

#include "flatland/scatterers/scatterer.h"
#include "mc/paths/walk/scene_scattering.h"
#include "tests/mc/estimates.h"
#include "tests/statistics.h"

namespace flatspeckle::mc::test_scattering {

namespace {

using tests::pi;

constexpr double k = 2 * pi;

BulkMedium cylinders(Scatterer::Kind kind, double ka, Complex index) {
  Scatterer scatterer;
  scatterer.kind = kind;
  scatterer.radius = ka / k;
  scatterer.index = index;
  return bulk_medium(scatterer, k, 1);
}

template <typename Scattering>
void check_towards(const Scattering& scattering) {
  Directions to(7);
  for (std::size_t j = 0; j < to.size(); ++j) {
    const double angle = 0.9 * static_cast<double>(j) - 3;
    to.set(j, direction(angle));
  }
  const Vec from = direction(2.4);
  std::vector<Complex> out(to.size(), Complex(0.5, 2));
  scattering.towards(from, to, out);
  for (std::size_t j = 0; j < to.size(); ++j) {
    const Complex expected = Complex(0.5, 2) * scattering.amplitude(from, to[j]);
    CHECK(std::abs(out[j] - expected) < 1e-11 * (1 + std::abs(expected)));
  }
}

/// Checks that sampled scattering angles follow the density.
template <typename Scattering>
void check_sampling(const Scattering& scattering) {
  constexpr int bins = 24, fine = 2000;
  const Vec from = direction(1.1);
  std::vector<double> counts(bins), probabilities(bins);
  RandomStream random(7, 78, 0);
  for (int i = 0; i < 20000; ++i) {
    const Vec next = scattering.sample(from, random);
    REQUIRE(std::abs(length(next) - 1) < 1e-12);
    const double turn = std::remainder(angle_of(next) - 1.1, 2 * pi);
    ++counts[std::clamp(static_cast<int>((turn / (2 * pi) + 0.5) * bins), 0, bins - 1)];
  }
  for (int i = 0; i < bins * fine; ++i) {
    const double turn = 2 * pi * ((i + 0.5) / (bins * fine) - 0.5);
    probabilities[i / fine] +=
        scattering.density(from, direction(1.1 + turn)) * 2 * pi / (bins * fine);
  }
  flatspeckle::tests::check_chi_square(counts, probabilities);
}

/// Checks that |A|^2 = p, that p depends only on the scattering angle, that lists of amplitudes
/// equal single ones and that samples follow p.
template <typename Scattering>
void check_consistency(const Scattering& scattering, double tolerance) {
  double largest = 0;
  for (const double turn : {0.0, 1e-4, 0.3, -0.3, 1.7, 3.1, pi}) {
    for (const double from : {0.0, -2.9, 1.3}) {
      const Vec in = direction(from), out = direction(from + turn);
      const double p = scattering.density(in, out);
      largest = std::max(largest, p);
      CAPTURE(turn);
      CHECK(std::abs(std::norm(scattering.amplitude(in, out)) - p) < tolerance * largest);
      CHECK(std::abs(scattering.density(out, in) - p) < 1e-8 * largest);
      // reversed paths of C14: A(-w' -> -w) = A(w -> w')
      CHECK(std::abs(scattering.density(-out, -in) - p) < 1e-8 * largest);
    }
  }
  check_towards(scattering);
  check_sampling(scattering);
}

}  // namespace

TEST_CASE("scattering amplitude: its squared modulus equals the phase function") {
  check_consistency(IsotropicScattering{}, 1e-14);
  for (const double g : {-0.5, 0.5, 0.99})
    check_consistency(HenyeyGreensteinScattering{{g}}, 1e-13);
  // between the nodes |linear A|^2 and linear |A|^2 differ by O(step^2)
  for (const double ka : {0.05, 1.0, 5.0, 50.0})
    check_consistency(TabulatedScattering(cylinders(Scatterer::Kind::tm, ka, 1.33), k), 1e-6);
  check_consistency(TabulatedScattering(cylinders(Scatterer::Kind::te, 2, {1.5, 0.1}), k), 1e-6);
  check_consistency(TabulatedScattering(cylinders(Scatterer::Kind::hard, 3, 1), k), 1e-6);
}

TEST_CASE("tabulated amplitude: agrees with the T-matrix in modulus and phase") {
  const BulkMedium medium = cylinders(Scatterer::Kind::tm, 5, {1.33, 0.01});
  const TabulatedScattering scattering(medium, k);
  for (const double turn : {0.0, 0.01, -0.37, 1.5, 3.0}) {
    const Complex expected = flatspeckle::amplitude(medium.t_matrix, k, turn) /
                             std::sqrt(medium.cross_sections.scattering);
    CHECK(std::abs(scattering.amplitude(direction(0.6), direction(0.6 + turn)) - expected) < 1e-5);
  }
}

TEST_CASE("thin TM cylinder: scatters isotropically") {
  const TabulatedScattering thin(cylinders(Scatterer::Kind::tm, 0.05, 1.5), k);
  for (const double turn : {0.0, 1.0, -2.0, pi})
    CHECK(thin.density(direction(0), direction(turn)) ==
          doctest::Approx(1 / (2 * pi)).epsilon(2e-3));
}

TEST_CASE("scattering in homogeneous media: forms of other media are rejected") {
  const Scene scene = tests::hg_box(6, 4, {3}, intensity_request({0.0}, {far_view(0)}));
  const auto ignored = [](const auto&) {};
  for (const auto phase : {Plan::Phase::varying, Plan::Phase::graded})
    CHECK_THROWS_AS(with_scattering(scene, phase, ignored), std::logic_error);
}

}  // namespace flatspeckle::mc::test_scattering
