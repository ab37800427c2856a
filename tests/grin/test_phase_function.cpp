#include <algorithm>
#include <numbers>

#include <doctest/doctest.h>

#include "core/numbers/random.h"
#include "grin/media/scattering/phase_function.h"
#include "tests/statistics.h"

namespace flatspeckle::grin::test_phase_function {

namespace {

constexpr double pi = std::numbers::pi;
constexpr double asymmetries[] = {-0.999, -0.5, 0, 0.5, 0.9, 0.99, 0.999};

/// Returns angles from -pi (Dimension 2) or 0 (3) to pi, denser towards 0 for small `width`.
std::vector<double> bin_edges(int dimension, double width, int bins = 80) {
  const double steepness = std::asinh(1 / width);
  std::vector<double> edges;
  for (int i = 0; i <= bins; ++i) {
    const double t = dimension == 2 ? 2.0 * i / bins - 1 : static_cast<double>(i) / bins;
    edges.push_back(pi * std::sinh(steepness * t) / std::sinh(steepness));
  }
  return edges;
}

/// Returns the probabilities of the bins, from the density per radian or per steradian alone.
template <typename Phase>
std::vector<double> probabilities(const Phase& phase, int dimension,
                                  const std::vector<double>& edges) {
  std::vector<double> result;
  for (std::size_t i = 0; i + 1 < edges.size(); ++i) {
    result.push_back(flatspeckle::tests::integral(
        [&](double angle) {
          return phase.density(angle) * (dimension == 2 ? 1 : 2 * pi * std::sin(angle));
        },
        edges[i], edges[i + 1]));
  }
  return result;
}

template <typename Phase>
std::vector<double> sampled_counts(const Phase& phase, const std::vector<double>& edges,
                                   std::uint64_t seed) {
  std::vector<double> counts(edges.size() - 1);
  RandomStream random(seed, 77, 0);
  bool in_range = true;
  for (int i = 0; i < 100000; ++i) {
    const double angle = phase.sample(random.uniform());
    const auto above = std::upper_bound(edges.begin() + 1, edges.end() - 1, angle);
    in_range = in_range && angle >= edges.front() && angle <= pi;
    ++counts[above - edges.begin() - 1];
  }
  CHECK(in_range);
  return counts;
}

template <typename Phase>
void check_sampler(const Phase& phase, int dimension, double width, std::uint64_t seed) {
  const auto edges = bin_edges(dimension, width);
  flatspeckle::tests::check_chi_square(sampled_counts(phase, edges, seed),
                                       probabilities(phase, dimension, edges));
}

/// Returns <cos^power> over all directions.
template <typename Phase>
double moment(const Phase& phase, int dimension, int power, double width) {
  double sum = 0;
  const auto edges = bin_edges(dimension, width);
  for (std::size_t i = 0; i + 1 < edges.size(); ++i) {
    sum += flatspeckle::tests::integral(
        [&](double angle) {
          return phase.density(angle) * std::pow(std::cos(angle), power) *
                 (dimension == 2 ? 1 : 2 * pi * std::sin(angle));
        },
        edges[i], edges[i + 1]);
  }
  return sum;
}

/// Returns the width for bin_edges. Bins that crowd at 0 do not resolve backward lobes.
double lobe_width(double g) {
  return g > 0 ? (1 - g) / 2 : 0.5;
}

template <int Dimension>
void check_henyey_greenstein(double g, std::uint64_t seed) {
  CAPTURE(Dimension);
  CAPTURE(g);
  const HenyeyGreenstein<Dimension> phase{g};
  CHECK(moment(phase, Dimension, 0, lobe_width(g)) == doctest::Approx(1).epsilon(1e-7));
  CHECK(moment(phase, Dimension, 1, lobe_width(g)) == doctest::Approx(g).epsilon(1e-7));
  if (g > -0.9) check_sampler(phase, Dimension, lobe_width(g), seed);
}

/// Returns <cos> of the sampler, the mean over its random number by the midpoint rule.
template <typename Phase>
double sampled_mean_cosine(const Phase& phase) {
  constexpr int points = 100000;
  double sum = 0;
  for (int i = 0; i < points; ++i) sum += std::cos(phase.sample((i + 0.5) / points));
  return sum / points;
}

double two_lobes(double angle) {
  return 3 * std::exp(-40 * angle * angle) + 0.2 * (1 - std::cos(angle));
}
/// Scatters to the sides only: 0 over two thirds of the circle.
double sideways(double angle) {
  return std::max(0.0, std::sin(angle) * std::sin(angle) - 0.75);
}

}  // namespace

TEST_CASE("isotropic phase function: normalised, mean cosine 0, samples agree with the density") {
  CHECK(moment(Isotropic<2>{}, 2, 0, 1) == doctest::Approx(1).epsilon(1e-12));
  CHECK(moment(Isotropic<3>{}, 3, 0, 1) == doctest::Approx(1).epsilon(1e-12));
  CHECK(std::abs(moment(Isotropic<2>{}, 2, 1, 1)) < 1e-12);
  CHECK(std::abs(moment(Isotropic<3>{}, 3, 1, 1)) < 1e-12);
  check_sampler(Isotropic<2>{}, 2, 1, 1);
  check_sampler(Isotropic<3>{}, 3, 1, 2);
}

TEST_CASE("Henyey-Greenstein: normalised, mean cosine g, samples agree with the density") {
  std::uint64_t seed = 10;
  for (const double g : asymmetries) {
    check_henyey_greenstein<2>(g, ++seed);
    check_henyey_greenstein<3>(g, ++seed);
  }
}

TEST_CASE("Henyey-Greenstein: the sampler's mean cosine is g") {
  for (const double g : asymmetries) {
    CAPTURE(g);
    CHECK(sampled_mean_cosine(HenyeyGreenstein<2>{g}) == doctest::Approx(g).epsilon(1e-6));
    CHECK(sampled_mean_cosine(HenyeyGreenstein<3>{g}) == doctest::Approx(g).epsilon(1e-5));
  }
}

TEST_CASE(
    "Henyey-Greenstein in flatland: agrees with C22, and the sampler inverts the distribution") {
  for (const double g : {-0.5, 0.3, 0.9}) {
    const HenyeyGreenstein<2> phase{g};
    for (const double angle : {-3.0, -0.4, 0.0, 1e-3, 2.0, pi}) {
      CHECK(phase.density(angle) ==
            doctest::Approx((1 - g * g) / (2 * pi * (1 + g * g - 2 * g * std::cos(angle)))));
    }
    for (const double u : {0.01, 0.3, 0.77, 0.999}) {
      const auto density = [&](double angle) { return phase.density(angle); };
      CHECK(flatspeckle::tests::integral(density, -pi, phase.sample(u)) ==
            doctest::Approx(u).epsilon(1e-8));
    }
  }
}

TEST_CASE("Henyey-Greenstein: extreme g and random numbers give finite angles and densities") {
  for (const double g : {-0.999, 0.0, 0.999}) {
    for (const double u : {0x1p-54, 0.5 - 0x1p-54, 0.5, 0.5 + 0x1p-53, 1 - 0x1p-53}) {
      CAPTURE(g);
      CAPTURE(u);
      const double flat = HenyeyGreenstein<2>{g}.sample(u),
                   space = HenyeyGreenstein<3>{g}.sample(u);
      CHECK(std::abs(flat) <= pi);
      CHECK((space >= 0 && space <= pi));
      CHECK(std::isfinite(HenyeyGreenstein<2>{g}.density(flat)));
      CHECK(HenyeyGreenstein<3>{g}.density(space) > 0);
    }
  }
  // p(0) and p(pi), where 1 + g^2 - 2 g cos cancels
  CHECK(HenyeyGreenstein<2>{0.999}.density(0) == doctest::Approx(1.999 / 0.001 / (2 * pi)));
  CHECK(HenyeyGreenstein<2>{0.999}.density(pi) == doctest::Approx(0.001 / 1.999 / (2 * pi)));
}

TEST_CASE("tabulated phase function: normalised, samples agree with the density") {
  std::uint64_t seed = 100;
  for (const auto& p : {two_lobes, sideways}) {
    const TabulatedPhaseFunction phase(p, 720);
    CHECK(moment(phase, 2, 0, 1) == doctest::Approx(1).epsilon(1e-6));
    check_sampler(phase, 2, 1, ++seed);
  }
  const TabulatedPhaseFunction coarse(two_lobes,
                                      7);  // its density is the table
  CHECK(moment(coarse, 2, 0, 1) == doctest::Approx(1).epsilon(1e-6));
  check_sampler(coarse, 2, 1, ++seed);
}

TEST_CASE("tabulated phase function: even, periodic, agrees with the tabulated function") {
  const TabulatedPhaseFunction phase(
      [](double angle) { return 5 * HenyeyGreenstein<2>{0.8}.density(angle); }, 4096);
  for (const double angle : {0.0, 0.1, 1.0, 3.0, pi}) {
    CHECK(phase.density(angle) ==
          doctest::Approx(HenyeyGreenstein<2>{0.8}.density(angle)).epsilon(1e-4));
    CHECK(phase.density(-angle) == phase.density(angle));
    CHECK(phase.density(angle + 4 * pi) == doctest::Approx(phase.density(angle)).epsilon(1e-10));
  }
  CHECK(sampled_mean_cosine(phase) == doctest::Approx(0.8).epsilon(1e-4));
}

TEST_CASE("tabulated phase function: no samples where the density is 0") {
  const TabulatedPhaseFunction phase(sideways, 720);
  RandomStream random(4, 77, 0);
  for (int i = 0; i < 10000; ++i) CHECK(phase.density(phase.sample(random.uniform())) > 0);
}

}  // namespace flatspeckle::grin::test_phase_function
