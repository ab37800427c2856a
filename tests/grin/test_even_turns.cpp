#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include <doctest/doctest.h>

#include "grin/media/scattering/even_turns.h"
#include "tests/statistics.h"

namespace flatspeckle::grin::test_even_turns {

using std::numbers::pi;

namespace {

const Vec3 before = Vec3(0.3, -0.5, -0.8).normalized();

std::vector<Vec3> turned(const SpacePhaseFunction& phase, int count, RandomStream& random) {
  EvenTurns turns(phase, before, count, random);
  std::vector<Vec3> directions;
  for (int i = 0; i < count; ++i) {
    RandomStream own(random.bits(), 0, 0);
    directions.push_back(turns.next(own));
  }
  return directions;
}

}  // namespace

TEST_CASE(
    "stratified scattering directions: each follows the phase function, with uniform azimuth") {
  constexpr int bins = 24, calls = 40000, count = 7;
  const HenyeyGreenstein<3> forward{0.8}, back{-0.3};
  for (const SpacePhaseFunction& phase :
       {SpacePhaseFunction{HgPhase{0.8}}, SpacePhaseFunction{TwoTermPhase{forward, back, 0.6}}}) {
    std::vector<double> cosines(bins), azimuths(bins);
    const Frame across = frame_across(before);
    RandomStream random(4, 98, 0);
    double longest = 0;
    for (int i = 0; i < calls; ++i) {
      const Vec3 direction = turned(phase, count, random)[random.bits() % count];
      longest = std::max(longest, direction.norm());
      const double turn =
          std::atan2(across.col(1).dot(direction), across.col(0).dot(direction)) / (2 * pi) + 0.5;
      ++cosines[static_cast<std::size_t>((direction.dot(before) + 1) / 2 * bins)];
      ++azimuths[static_cast<std::size_t>(turn * bins) % bins];
    }
    CHECK(longest == doctest::Approx(1).epsilon(1e-12));
    std::vector<double> probabilities;
    for (int i = 0; i < bins; ++i)
      probabilities.push_back(
          flatspeckle::tests::integral([&](double c) { return 2 * pi * phase.density(c); },
                                       2.0 * i / bins - 1, 2.0 * (i + 1) / bins - 1));
    flatspeckle::tests::check_chi_square(cosines, probabilities);
    flatspeckle::tests::check_chi_square(azimuths, std::vector<double>(bins, 1.0 / bins));
  }
}

TEST_CASE("stratified scattering directions: one in each stratum of the phase function") {
  constexpr int count = 16;
  const HgPhase phase{0.9};
  RandomStream random(4, 98, 1);
  const auto directions = turned({phase}, count, random);
  for (int i = 0; i < count; ++i) {
    const auto at = [&](double place) {
      return 1 - HenyeyGreenstein<3>{phase.g}.sample_one_minus_cosine(place);
    };
    const double cosine = directions[static_cast<std::size_t>(i)].dot(before);
    CHECK(cosine >= at(static_cast<double>(i) / count) - 1e-12);
    CHECK(cosine <= at((i + 1.0) / count) + 1e-12);
  }
}

TEST_CASE(
    "stratified Russian roulette: survival agrees with the probabilities, counts with their sum") {
  constexpr int calls = 20000;
  const std::vector<double> probabilities{0.3, 0.05, 0.9, 0.4, 0.01};
  std::vector<double> kept(probabilities.size());
  bool is_near = true;
  RandomStream random(4, 98, 2);
  for (int i = 0; i < calls; ++i) {
    EvenTermination roulette(random);
    int count = 0;
    for (std::size_t k = 0; k < probabilities.size(); ++k) {
      const bool stays = roulette.keeps(probabilities[k]);
      kept[k] += stays;
      count += stays;
    }
    is_near &= count == 1 || count == 2;  // their mean is 1.66
  }
  CHECK(is_near);
  for (std::size_t k = 0; k < probabilities.size(); ++k)
    CHECK(std::abs(kept[k] / calls - probabilities[k]) <
          4 * std::sqrt(probabilities[k] * (1 - probabilities[k]) / calls));
}

}  // namespace flatspeckle::grin::test_even_turns
