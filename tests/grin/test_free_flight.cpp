#include <doctest/doctest.h>

#include "core/numbers/random.h"
#include "grin/media/scattering/free_flight.h"
#include "tests/statistics.h"

namespace flatspeckle::grin::test_free_flight {

using flatspeckle::tests::is_night;

namespace {

constexpr int bins = 50;

template <typename Sample, typename Density>
void check_flight(Sample sample, Density density, double longest, std::uint64_t seed) {
  std::vector<double> counts(bins), probabilities(bins);
  RandomStream random(seed, 78, 0);
  const auto edge = [&](int bin) { return longest * bin / bins; };
  for (int i = 0; i < 100000; ++i) {
    const double distance = sample(random.uniform());
    if (distance >= 0 && distance < longest) ++counts[static_cast<int>(distance / longest * bins)];
  }
  for (int bin = 0; bin < bins; ++bin)
    probabilities[bin] = flatspeckle::tests::integral(density, edge(bin), edge(bin + 1));
  flatspeckle::tests::check_chi_square(counts, probabilities);
}

}  // namespace

TEST_CASE("bounded flights: samples agree with the density, which integrates to 1, thin to thick") {
  std::uint64_t seed = 0;
  for (const double depth : {0.0, 1e-12, 1e-3, 1.0, 20.0, 100.0}) {
    CAPTURE(depth);
    const double longest = 2.5;
    const BoundedFlight flight{depth / longest, longest};
    const auto density = [&](double s) { return flight.density(s); };
    // beyond 20 mean free paths bins would be empty
    const double seen = depth > 20 ? longest * 20 / depth : longest;
    CHECK(flatspeckle::tests::integral(density, 0, seen) == doctest::Approx(1).epsilon(1e-8));
    check_flight([&](double u) { return flight.sample(u); }, density, seen, ++seed);
  }
}

TEST_CASE("bounded flights: in bounds and inverse of the distribution at extreme random numbers") {
  for (const double depth : {0.0, 1e-300, 1e-12, 1.0, 100.0, 1e5}) {
    const BoundedFlight flight{depth / 3, 3};
    for (const double u : {0x1p-54, 1e-3, 0.5, 1 - 1e-3, 1 - 0x1p-53}) {
      CAPTURE(depth);
      CAPTURE(u);
      const double distance = flight.sample(u);
      CHECK(distance >= 0);
      CHECK(distance <= 3 * (1 + 1e-15));
      CHECK(std::isfinite(flight.density(distance)));
      // u is the fraction of the extinction before that distance
      if (depth == 1) {
        CHECK(std::expm1(-distance / 3) / std::expm1(-1) == doctest::Approx(u).epsilon(1e-12));
      }
      if (depth <= 1e-12) CHECK(distance == doctest::Approx(3 * u).epsilon(1e-10));
    }
  }
}

TEST_CASE("free flights: the fraction beyond a distance agrees with the transmittance") {
  const double mu_t = 0.7;
  double longer = 0;
  RandomStream random(9, 78, 0);
  constexpr int flights = 100000;
  for (int i = 0; i < flights; ++i) longer += sample_free_flight(mu_t, random.uniform()) > 2;
  const double expected = transmittance(mu_t, 2);
  CHECK(expected == doctest::Approx(std::exp(-1.4)));
  CHECK(std::abs(longer / flights - expected) < 4 * std::sqrt(expected * (1 - expected) / flights));
  CHECK(std::isfinite(sample_free_flight(mu_t, 0x1p-54)));
}

/// The mean of exp(-k s), s in mean free paths, is 1 / (1 + k).
TEST_CASE(
    "exponential transform: weighted means agree with the closed form, weights with the bias") {
  const int places = is_night ? 1 << 20 : 1 << 18;
  constexpr double bias = 0.7;
  for (const double depth : {0.0, 1e-6, 0.5, 3.0, 30.0}) {
    CAPTURE(depth);
    for (const double k : {0.0, 0.5, 3.0, -0.6}) {
      double sum = 0;
      for (int i = 0; i < places; ++i) {
        const auto [u, weight] = ImportanceSampledFlight::at((i + 0.5) / places, depth, bias);
        sum += weight * std::pow(u, k) / places;
      }
      CHECK(sum == doctest::Approx(1 / (1 + k)).epsilon(k < 0 ? 0.01 : 1e-5));
    }
    double least = 1e9, most = 0;
    bool is_number = true;
    for (int i = 0; i < places; ++i) {
      const auto [u, weight] = ImportanceSampledFlight::at((i + 0.5) / places, depth, bias);
      is_number &= u > 0 && u < 1;
      if (!(u > std::exp(-depth))) continue;
      const double scaled_weight = weight * std::pow(u, -bias);
      least = std::min(least, scaled_weight);
      most = std::max(most, scaled_weight);
    }
    CHECK(is_number);
    if (most > 0) CHECK(least == doctest::Approx(most).epsilon(1e-9));
  }
}

}  // namespace flatspeckle::grin::test_free_flight
