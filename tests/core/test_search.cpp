#include <cmath>
#include <map>

#include <doctest/doctest.h>

#include "core/numbers/random.h"
#include "core/search/noisy_search.h"

namespace flatspeckle::test_search {

namespace {

/// Two unequal hills: the higher at (0.3, 0.6) of height 1, the other at (0.8, 0.2) of `second`.
double hills(const UnitPlace& at, double second = 0.9) {
  const auto hill = [&](double x, double y, double width) {
    const double dx = (at[0] - x) / width, dy = (at[1] - y) / width;
    return std::exp(-(dx * dx + dy * dy) / 2);
  };
  return hill(0.3, 0.6, 0.12) + second * hill(0.8, 0.2, 0.12);
}

double normal(RandomStream& random) {
  return std::sqrt(-2 * std::log(random.uniform())) *
         std::cos(6.283185307179586 * random.uniform());
}

/// Measurement of the hills with noise: a plane common to all places of a draw, which nearly
/// cancels in differences, and independent noise of each place.
struct NoisyHills {
  double common = 0.3, own = 0.03;
  std::uint64_t seed = 1;
  double second = 0.9;
  mutable double samples = 0;

  Measured at(const SearchPlace& place, const SearchEffort& effort) const {
    constexpr std::size_t blocks = 32;
    const double scale = std::sqrt(blocks / effort.samples);
    RandomStream of_draw(seed, effort.draw, static_cast<std::uint64_t>(effort.samples));
    const auto hash = [](double x) { return static_cast<std::uint64_t>(x * 1e15); };
    RandomStream of_place(seed ^ hash(place.at[0]), hash(place.at[1]), effort.draw);
    std::vector<double> values;
    double mean = 0;
    for (std::size_t b = 0; b < blocks; ++b) {
      const double noise =
          common * (normal(of_draw) + 0.2 * normal(of_draw) * place.at[0]) + own * normal(of_place);
      values.push_back(hills(place.at, second) + scale * noise);
      mean += values.back() / blocks;
    }
    Measured found{mean};
    for (const double value : values)
      found.without.push_back((blocks * mean - value) / (blocks - 1));
    samples += effort.samples;
    return found;
  }
  SearchTask task() const {
    SearchTask task{.dimensions = 2, .choices = 1, .measure = {}};
    task.measure = [this](const std::vector<SearchPlace>& places, const SearchEffort& effort) {
      std::vector<Measured> found;
      for (const SearchPlace& place : places) found.push_back(at(place, effort));
      return found;
    };
    return task;
  }
};

}  // namespace

TEST_CASE("differences of measurements: common noise cancels in their errors") {
  const NoisyHills noisy{.common = 0.3, .own = 0};
  const SearchPlace a{{0.3, 0.6}}, b{{0.3, 0.5}};
  const Measured at_a = noisy.at(a, {}), at_b = noisy.at(b, {});
  CHECK(error(at_a) == doctest::Approx(0.3).epsilon(0.5));
  const Difference found = difference(at_a, at_b);
  CHECK(found.value == doctest::Approx(hills(a.at) - hills(b.at)).epsilon(1e-9));
  CHECK(found.error < 1e-12);
  CHECK(difference(at_b, at_a).confidence() < 1e-6);
  CHECK(difference(at_a, at_a).confidence() == 0.5);
  CHECK(error(Measured{2}) == 0);
}

TEST_CASE("ratio of measurements: common relative noise cancels in its error") {
  const Measured a{4, {3.9, 4.1}}, b{2, {1.95, 2.05}};
  CHECK(ratio(a, b).value == 2);
  CHECK(error(ratio(a, b)) < 1e-15);
}

TEST_CASE("without_blocks: jackknife sums without one block each") {
  GroupedSums sums(2);
  for (int batch = 0; batch < 600; ++batch)
    sums.add(3, std::vector<Complex>{Complex(batch), Complex(0, 1)});
  const auto without = without_blocks(sums, 32);
  REQUIRE(without.size() == 32);
  Complex total = 0;
  for (const GroupedSums& rest : without) total += rest.total()[0];
  CHECK(std::abs(total - 31.0 * sums.total()[0]) < 1e-6);
  // Block 0 has groups 0, 32, ..., whose batches are these, including those added later.
  double own = 0;
  for (int batch = 0; batch < 600; ++batch)
    if (batch % 256 % 32 == 0) own += batch;
  CHECK(std::abs(without[0].total()[0] - (sums.total()[0] - own)) < 1e-9);
  CHECK(without_blocks(sums, 1000).size() == 256);
}

TEST_CASE("search: finds the higher of two hills without noise") {
  NoisyHills exact{.common = 0, .own = 0};
  SearchTask task = exact.task();
  task.measure = [&](const std::vector<SearchPlace>& places, const SearchEffort&) {
    std::vector<Measured> found;
    for (const SearchPlace& place : places) found.push_back({hills(place.at)});
    return found;
  };
  const SearchSettings settings{.scattered = 32};
  const SearchEnd end = noisy_search(task, settings);
  CHECK(end.finished);
  const Winner winner = chosen_winner(task, settings, end.best);
  CHECK(winner.best.place.at[0] == doctest::Approx(0.3).epsilon(3e-3));
  CHECK(winner.best.place.at[1] == doctest::Approx(0.6).epsilon(3e-3));
  CHECK(winner.best.measured.value == doctest::Approx(1).epsilon(1e-4));
  CHECK(winner.runner_up.place.at[0] == doctest::Approx(0.8).epsilon(0.1));
  CHECK(winner.lead.confidence() == 1);
}

/// The function resembles the power of a guide: it rises towards a face with two maxima.
TEST_CASE("search: finds a narrow hill on a face of the cube next to a wide one") {
  const auto height = [](const UnitPlace& at) {
    const double wide = 0.75 * at[0] * std::exp(-std::pow(at[1] - 0.4, 2) / 0.1);
    return wide + std::exp(-(1 - at[0]) / 0.1 - std::pow(at[1] - 0.85, 2) / 0.02);
  };
  SearchTask task{.dimensions = 2, .measure = {}};
  task.measure = [&](const std::vector<SearchPlace>& places, const SearchEffort&) {
    std::vector<Measured> found;
    for (const SearchPlace& place : places) found.push_back({height(place.at)});
    return found;
  };
  for (const std::size_t scattered : {48, 64, 96, 128}) {
    CAPTURE(scattered);
    const SearchSettings settings{.scattered = scattered};
    const Winner winner = chosen_winner(task, settings, noisy_search(task, settings).best);
    CHECK(winner.best.place.at[0] == 1);
    CHECK(winner.best.place.at[1] == doctest::Approx(0.85).epsilon(0.02));
  }
}

TEST_CASE("search: one dimension and a choice") {
  SearchTask task{.dimensions = 1, .choices = 3, .measure = {}};
  task.measure = [](const std::vector<SearchPlace>& places, const SearchEffort&) {
    std::vector<Measured> found;
    for (const auto& [at, choice] : places)
      found.push_back({static_cast<double>(choice) -
                       std::pow(at[0] - 0.1 - 0.3 * static_cast<double>(choice), 2)});
    return found;
  };
  const SearchSettings settings{.scattered = 24};
  const Winner winner = chosen_winner(task, settings, noisy_search(task, settings).best);
  CHECK(winner.best.place.choice == 2);
  CHECK(winner.best.place.at[0] == doctest::Approx(0.7).epsilon(3e-3));
}

/// No place is measured twice.
TEST_CASE("search: places of many choices are distributed evenly over each") {
  for (const std::size_t choices : {1, 8, 21, 34, 55, 100}) {
    CAPTURE(choices);
    std::vector<std::vector<double>> tried(choices);
    SearchTask task{.dimensions = 1, .choices = choices, .measure = {}};
    bool is_first = true;
    task.measure = [&](const std::vector<SearchPlace>& places, const SearchEffort&) {
      for (const auto& [at, choice] : places)
        if (is_first) tried[choice].push_back(at[0]);
      is_first = false;
      return std::vector<Measured>(places.size());
    };
    noisy_search(task, {.scattered = 16 * choices});
    for (std::vector<double>& places : tried) {
      std::ranges::sort(places);
      CHECK(std::ranges::adjacent_find(places) == places.end());
      double widest = std::max(places.front(), 1 - places.back());
      for (std::size_t i = 1; i < places.size(); ++i)
        widest = std::max(widest, places[i] - places[i - 1]);
      CHECK(widest < 3.0 / 16);
    }
  }
}

/// The winner is measured again, so that its value is unbiased over many searches; values that
/// guided the search are biased upward.
TEST_CASE("search with noise: the winner is within the target error and unbiased") {
  constexpr int searches = 40;
  double mean_deviation = 0, mean_square_deviation = 0, selection_bias = 0, shortfall2 = 0;
  int higher = 0;
  constexpr double target = 0.01;
  for (int seed = 1; seed <= searches; ++seed) {
    const NoisyHills noisy{.seed = static_cast<std::uint64_t>(seed)};
    const SearchSettings settings{.scattered = 32, .target_error = target};
    const SearchEnd end = noisy_search(noisy.task(), settings);
    const Winner winner = chosen_winner(noisy.task(), settings, end.best);
    const double there = hills(winner.best.place.at);
    const double deviation = (winner.best.measured.value - there) / error(winner.best.measured);
    mean_deviation += deviation / searches;
    mean_square_deviation += deviation * deviation / searches;
    const FoundPlace& first = end.best.front();
    selection_bias += (first.measured.value - hills(first.place.at)) / searches;
    higher += winner.best.place.at[0] < 0.55;
    shortfall2 += (1 - there) * (1 - there) / searches;
    CHECK(winner.reached);
  }
  CHECK(std::abs(mean_deviation) < 4 / std::sqrt(searches));
  CHECK(mean_square_deviation == doctest::Approx(1).epsilon(0.6));
  CHECK(selection_bias > 0);
  CHECK(higher == searches);
  // Places are distinguished to the target error, which limits the distance from the maximum.
  CHECK(std::sqrt(shortfall2) < target);
}

/// The fraction of correct winners agrees with the confidence.
TEST_CASE("search: the confidence agrees with the frequency of correct winners") {
  constexpr int searches = 60;
  double expected = 0, better = 0, variance = 0;
  for (int seed = 1; seed <= searches; ++seed) {
    const NoisyHills noisy{
        .common = 0, .own = 0.3, .seed = static_cast<std::uint64_t>(seed), .second = 0.98};
    const SearchSettings settings{.target_error = 0.06, .most_samples = 16};
    const std::vector<FoundPlace> both = {{{{0.3, 0.6}}, {}, 4}, {{{0.8, 0.2}}, {}, 4}};
    const Winner winner = chosen_winner(noisy.task(), settings, both);
    const double confidence = winner.lead.confidence();
    expected += confidence;
    variance += confidence * (1 - confidence);
    better += winner.best.place.at[0] < 0.5;
  }
  CHECK(std::abs(better - expected) < 4 * std::sqrt(variance));
}

}  // namespace flatspeckle::test_search
