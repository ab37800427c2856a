#include <cmath>

#include <doctest/doctest.h>

#include "core/numbers/random.h"
#include "core/numbers/statistics.h"

namespace flatspeckle::test_control_variate {

namespace {

double noise(RandomStream& random) {
  double sum = -6;
  for (int i = 0; i < 12; ++i) sum += random.uniform();
  return sum;
}

/// Returns sums of batches: one highly correlated with the control, one uncorrelated, the control.
GroupedSums sums_of(std::uint64_t seed, int batches) {
  GroupedSums sums(3);
  RandomStream random(seed, 1, 0);
  for (int i = 0; i < batches; ++i) {
    const double control = noise(random);
    sums.add(
        1, std::vector<Complex>{2 + 3 * control + 0.1 * noise(random), 5 + noise(random), control});
  }
  return sums;
}

std::vector<Complex> first_two(double samples, std::span<const Complex> sums) {
  return sample_mean(samples, sums.first(2));
}

}  // namespace

constexpr std::size_t third[] = {2};

TEST_CASE("control variate: reduces the error of a correlated mean, and errors are correct") {
  double squares = 0;
  const int runs = 200;
  for (int seed = 1; seed <= runs; ++seed) {
    const GroupedSums sums = sums_of(seed, 400);
    const Estimate found = controlled_jackknife(sums, first_two, third),
                   plain = jackknife(sums, first_two);
    CHECK(found.error[0] < 0.05 * plain.error[0]);
    const double off = (found.value[0].real() - 2) / found.error[0];
    squares += off * off / runs;
  }
  CHECK(squares == doctest::Approx(1).epsilon(4 * std::sqrt(2.0 / runs)));
}

TEST_CASE("control variate: uncorrelated means and few batches are unchanged") {
  const GroupedSums sums = sums_of(1, 400);
  CHECK(controlled_jackknife(sums, first_two, third).value[1] ==
        jackknife(sums, first_two).value[1]);
  const GroupedSums few = sums_of(1, 20);
  CHECK(controlled_jackknife(few, first_two, third).value[0] == jackknife(few, first_two).value[0]);
}

TEST_CASE("control variates: act together where each alone explains nothing") {
  GroupedSums sums(4);
  RandomStream random(3, 1, 0);
  for (int i = 0; i < 400; ++i) {
    const double shared = 20 * noise(random), own = noise(random);
    sums.add(1, std::vector<Complex>{2 + 3 * own + 0.1 * noise(random), shared + own, shared - own,
                                     2 * shared});
  }
  const auto first = [](double samples, std::span<const Complex> all) {
    return sample_mean(samples, all.first(1));
  };
  constexpr std::size_t alone[] = {1}, all[] = {1, 2, 3};  // the third depends on the others
  const double plain = jackknife(sums, first).error[0];
  CHECK(controlled_jackknife(sums, first, alone).error[0] > 0.9 * plain);
  const Estimate found = controlled_jackknife(sums, first, all);
  CHECK(found.error[0] < 0.05 * plain);
  CHECK(std::abs(found.value[0].real() - 2) < 4 * found.error[0]);
}

}  // namespace flatspeckle::test_control_variate
