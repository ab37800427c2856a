#include <algorithm>
#include <cmath>
#include <vector>

#include <boost/math/distributions/normal.hpp>

#include "tests/mc/transport/slabs.h"
#include "tests/statistics.h"

namespace flatspeckle::mc::test_against_monte_carlo {

namespace {

constexpr double precise = 1e-3;

/// Returns the largest error relative to `size`, the roots of each entry's two intensities.
double largest(const Estimate& found, const std::vector<double>& size) {
  double worst = 0;
  for (std::size_t e = 0; e < size.size(); ++e) worst = std::max(worst, found.error[e] / size[e]);
  return worst;
}

/// Increases the paths until every error is `precise`; each run sets the number of the next.
Estimate precise_estimate(const Scene& scene, std::uint64_t seed, const std::vector<double>& size) {
  constexpr double margin = 1.2, most_growth = 50;
  double paths = 20000;
  for (std::uint64_t round = 0;; ++round) {
    const auto found = tests::run(scene, ReversedPaths::yes, static_cast<std::uint64_t>(paths),
                                  seed + 1000 * round)
                           .entries();
    const double missing = largest(found, size) / precise;
    if (missing <= 1) return found;
    paths *= std::min(margin * missing * missing, most_growth);
  }
}

/// Returns the Kolmogorov-Smirnov distance from the standard normal distribution, with Stephens'
/// (1970) factor for few samples.
double distance_from_normal(std::vector<double> z) {
  std::ranges::sort(z);
  const boost::math::normal normal;
  const auto count = static_cast<double>(z.size());
  double distance = 0;
  for (std::size_t i = 0; i < z.size(); ++i) {
    const double below = boost::math::cdf(normal, z[i]), rank = static_cast<double>(i);
    distance = std::max({distance, below - rank / count, (rank + 1) / count - below});
  }
  return distance * (std::sqrt(count) + 0.12 + 0.11 / std::sqrt(count));
}

}  // namespace

namespace {

/// Deviation of one intensity per slab from transport, in standard errors. Every entry must be
/// within four.
class Deviations {
 public:
  void add(const Scene& scene, std::uint64_t seed, const std::vector<Complex>& expected,
           const Estimate& found) {
    CAPTURE(seed);
    std::vector<double> intensities;
    for (std::size_t e = 0; e < expected.size(); ++e) {
      CAPTURE(e);
      CHECK_WITHIN_4_SIGMA(found.value[e], found.error[e], expected[e], 0);
      if (scene.request.entries[e].a == scene.request.entries[e].b)
        intensities.push_back((found.value[e] - expected[e]).real() / found.error[e]);
    }
    z_.push_back(intensities[seed % intensities.size()]);
  }

  void check_normal() const {
    constexpr double one_percent = 1.628;  // quantile of Kolmogorov's distribution
    MESSAGE(z_.size(), " slabs, Kolmogorov-Smirnov distance ", distance_from_normal(z_));
    CHECK(distance_from_normal(z_) < one_percent);
  }

 private:
  std::vector<double> z_;
};

}  // namespace

TEST_CASE("nightly: sixty random slabs: Monte Carlo is normal about transport to 0.1 %") {
  Deviations deviations;
  for (std::uint64_t seed = 1; seed <= 60; ++seed) {
    const Scene scene = tests::RandomSlab(flatspeckle::tests::fresh_seed(seed)).scene();
    const auto expected = slab_covariance(scene, true, {1e-5}).value;
    const auto size = scales(scene.request.entries, expected);
    deviations.add(scene, seed, expected, precise_estimate(scene, seed, size));
  }
  deviations.check_normal();
}

TEST_CASE("nightly: slabs of optical depth 1e-3 to 100: Monte Carlo agrees with transport") {
  Deviations deviations;
  for (std::uint64_t seed = 1; seed <= 60; ++seed) {
    const Scene scene =
        tests::RandomSlab(flatspeckle::tests::fresh_seed(seed), {1e-3, 100, -0.9, 0.99}).scene();
    // in thin slabs rare paths along the slab dominate the error
    const double optical_depth = scene.medium.mu_t * scene.domain.depth,
                 paths = 20000 + 400000 / (1 + optical_depth);
    deviations.add(
        scene, seed, slab_covariance(scene, true, {1e-5}).value,
        tests::run(scene, ReversedPaths::yes, static_cast<std::uint64_t>(paths), seed).entries());
  }
  deviations.check_normal();
}

}  // namespace flatspeckle::mc::test_against_monte_carlo
