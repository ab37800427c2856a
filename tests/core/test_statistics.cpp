#include <cmath>
#include <limits>

#include <doctest/doctest.h>

#include "core/error.h"
#include "core/numbers/random.h"
#include "core/numbers/statistics.h"

namespace flatspeckle::test_statistics {

TEST_CASE("jackknife: the error of a mean is the standard error of the mean") {
  GroupedSums sums(1);
  std::vector<Complex> values;
  RandomStream random(1, 1, 0);
  for (int i = 0; i < 100; ++i) {
    values.emplace_back(random.uniform(), 3 * random.uniform());
    sums.add(1, {&values.back(), 1});
  }
  Complex mean = 0;
  for (auto value : values) mean += value / 100.0;
  double variance = 0;
  for (auto value : values) variance += std::norm(value - mean) / 99.0;
  const auto estimate = jackknife(sums, sample_mean);
  CHECK(std::abs(estimate.value[0] - mean) < 1e-14);
  CHECK(estimate.error[0] == doctest::Approx(std::sqrt(variance / 100)).epsilon(1e-10));
}

TEST_CASE("jackknife: the bias of a squared mean is the variance of the mean") {
  GroupedSums sums(1), one(1);
  RandomStream random(5, 1, 0);
  double sum = 0, squares = 0;
  for (int i = 0; i < 50; ++i) {
    const double value = random.uniform();
    const Complex entry = value;
    sums.add(1, {&entry, 1});
    sum += value;
    squares += value * value;
  }
  const Estimator square = [](double samples, std::span<const Complex> total) {
    return std::vector<Complex>{std::pow(total[0] / samples, 2)};
  };
  const double variance = (squares - sum * sum / 50) / 49;
  CHECK(jackknife_bias(sums, square)[0].real() == doctest::Approx(variance / 50).epsilon(1e-9));
  const Complex entry = 2;
  one.add(1, {&entry, 1});
  CHECK(jackknife_bias(one, square)[0] == 0.0);
}

TEST_CASE("jackknife: sums of entries agree with the general estimator") {
  constexpr std::size_t size = 20, first = 3, count = 12;
  for (const int batches : {1, 2, 40, 700}) {  // with 700, groups have unequal size
    GroupedSums sums(size);
    RandomStream random(3, 1, 0);
    for (int batch = 0; batch < batches; ++batch) {
      std::vector<Complex> values;
      for (std::size_t i = 0; i < sums.size(); ++i)
        values.emplace_back(random.uniform() + (i < 4 && batch % 90 == 1 ? 1e3 : 0),
                            i < 8 ? random.uniform() : 0);
      sums.add(16, values);
    }
    const Estimate expected = part(jackknife(sums, sample_mean), first, count),
                   found = jackknife(sums, EntryRange{first, count});
    CHECK(found.value == expected.value);
    for (std::size_t i = 0; i < count; ++i)
      if (batches > 1)
        CHECK(found.error[i] == doctest::Approx(expected.error[i]).epsilon(1e-9));
      else
        CHECK(std::isinf(found.error[i]));
    CHECK(found.rare == expected.rare);
  }
}

TEST_CASE("jackknife: errors of values whose squares underflow") {
  for (const double tiny : {1e-120, 1e-240, 1e-290}) {
    GroupedSums sums(1), small(1);
    RandomStream random(1, 1, 0);
    for (int i = 0; i < 100; ++i) {
      const Complex value(random.uniform(), random.uniform()), less = tiny * value;
      sums.add(1, {&value, 1});
      small.add(1, {&less, 1});
    }
    const Estimate expected = jackknife(sums, sample_mean), found = jackknife(small, sample_mean);
    CHECK(found.error[0] / tiny == doctest::Approx(expected.error[0]).epsilon(1e-10));
    CHECK(relative_error(found) == doctest::Approx(relative_error(expected)).epsilon(1e-10));
  }
}

TEST_CASE("jackknife: errors due to a few batches are marked as rare, rounding errors are not") {
  // Regular, dominated by one batch in 100, equal up to rounding, and exact values.
  GroupedSums sums(4);
  RandomStream random(1, 1, 0);
  for (int i = 0; i < 400; ++i) {
    const double normal = random.uniform() + random.uniform() + random.uniform();
    const double strong = i % 100 == 17 ? 50 : 0;
    const double rounded = i % 100 == 17 ? std::nextafter(1.0, 2.0) : 1;
    const std::vector<Complex> values{normal, normal + strong, rounded, 1};
    sums.add(1, values);
  }
  const Estimate estimate = jackknife(sums, sample_mean);
  CHECK(estimate.rare == std::vector<std::uint64_t>{0, 1, 0, 0});
  CHECK(part(estimate, 1, 2).rare == std::vector<std::uint64_t>{1, 0});
}

TEST_CASE("jackknife: small numbers of batches are not marked as rare") {
  for (const int batches : {0, 1, 2, 3, 5, 10, 20}) {
    GroupedSums sums(1);
    RandomStream random(1, 1, 0);
    for (int i = 0; i < batches; ++i) {
      const Complex value = random.uniform();
      sums.add(1, {&value, 1});
    }
    CHECK(jackknife(sums, sample_mean).rare[0] == 0);
  }
}

TEST_CASE("jackknife: errors are correct with more batches than groups of unequal size") {
  // 300 batches in 256 groups: 44 groups contain two batches. The variance of many such estimates
  // is known: a uniform number has variance 1/12.
  double mean_variance = 0, mean_error2 = 0;
  constexpr int repeats = 400, batches = 300;
  for (int r = 0; r < repeats; ++r) {
    RandomStream random(2, 1, static_cast<std::uint64_t>(r));
    GroupedSums sums(1);
    for (int b = 0; b < batches; ++b) {
      const Complex u = random.uniform();
      sums.add(1, {&u, 1});
    }
    CHECK(sums.groups() == 256);
    const auto estimate = jackknife(sums, sample_mean);
    mean_variance += std::norm(estimate.value[0] - 0.5) / repeats;
    mean_error2 += estimate.error[0] * estimate.error[0] / repeats;
  }
  const double expected = 1.0 / 12 / batches;
  CHECK(mean_error2 == doctest::Approx(expected).epsilon(0.03));
  CHECK(mean_variance == doctest::Approx(expected).epsilon(4 * std::sqrt(2.0 / repeats)));
}

TEST_CASE("jackknife: the error of a ratio has the correct coverage") {
  // X/Y with X = y + noise: the delta method gives the error of the ratio of means.
  const auto ratio = [](double, std::span<const Complex> s) {
    return std::vector<Complex>{s[0] / s[1]};
  };
  int covered = 0;
  constexpr int repeats = 400;
  for (int r = 0; r < repeats; ++r) {
    RandomStream random(4, 1, static_cast<std::uint64_t>(r));
    GroupedSums sums(2);
    for (int b = 0; b < 200; ++b) {
      const double y = 1 + random.uniform(), x = 2 * y + random.uniform() - 0.5;
      const Complex row[] = {x, y};
      sums.add(1, row);
    }
    const auto estimate = jackknife(sums, ratio);
    if (std::abs(estimate.value[0] - 2.0) < 2 * estimate.error[0]) ++covered;
  }
  // 95.4 % expected, standard deviation of the count 4.2
  CHECK(covered > 0.954 * repeats - 4 * 4.2);
  CHECK(covered < 0.954 * repeats + 4 * 4.2);
}

TEST_CASE("jackknife: one batch has an infinite error, zero values have error 0") {
  GroupedSums sums(1);
  const Complex one = 1;
  sums.add(1, {&one, 1});
  CHECK(jackknife(sums, sample_mean).error[0] == std::numeric_limits<double>::infinity());
  CHECK(relative_error({{0, 0}, {0, 0}}) == 0);
  CHECK(relative_error({{3, Complex(0, 4)}, {0.3, 0.4}}) == doctest::Approx(0.1));
}

TEST_CASE("grouped sums: the state is restored bit for bit, another shape is rejected") {
  GroupedSums sums(3), other(3);
  const Complex row[] = {1.5, Complex(0, 2), -3};
  for (int i = 0; i < 5; ++i) sums.add(2, row);
  other.restore(sums.state());
  CHECK(other.batches() == 5);
  CHECK(other.total() == sums.total());
  CHECK(other.total_samples() == 10);
  GroupedSums narrow(1);
  CHECK_THROWS_AS(narrow.restore(sums.state()), InputError);
}

TEST_CASE("grouped sums: long rows have fewer groups, so that the sums fit in memory") {
  GroupedSums narrow(1), wide(1 << 20);
  const std::vector<Complex> row(wide.size(), 1.0);
  for (std::size_t batch = 1; batch <= 300; ++batch) {
    narrow.add(2, std::span(row).first(1));
    CHECK(narrow.groups() == std::min<std::size_t>(batch, 256));
  }
  CHECK(narrow.total()[0] == 300.0);
  CHECK(narrow.total_samples() == 600);
  for (int batch = 0; batch < 17; ++batch) wide.add(1, row);
  CHECK(wide.groups() == 16);
}

}  // namespace flatspeckle::test_statistics
