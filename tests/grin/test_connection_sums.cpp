#include "bench/scenes/random_fields.h"
#include "tests/grin/curve_sums.h"

namespace flatspeckle::grin::tests::test_connection_sums {

using flatspeckle::tests::is_night;

TEST_CASE("connection sums in Luneburg's ball: the mean of f K is f of the only curve") {
  const Inside<bench::Ball> ball{{1}};
  std::vector<HarmonicCurve> exact = harmonic_curves(from, to, 2 * std::numbers::pi);
  std::erase_if(exact, [](const HarmonicCurve& curve) { return curve.largest_radius() > 1; });
  REQUIRE(exact.size() == 1);
  const ConnectionTrial trial(field, ball, from, to, {.step = 0.1, .max_length = 4});
  const int estimates = is_night ? 400000 : 40000;
  check_sums(estimated(trial, estimates, 81), estimates, exact, is_night ? 0.002 : 0.006);
}

TEST_CASE("connection sums without the rim: the mean of f K is the sum of f over four curves") {
  check_four_curves(is_night ? 60'000 : 4'000, is_night ? 0.007 : 0.03);
}

TEST_CASE("connection sums: Russian roulette does not change the mean") {
  std::vector<HarmonicCurve> exact = harmonic_curves(from, to, 6 * std::numbers::pi);
  const double longest = 6;
  std::erase_if(exact, [&](const HarmonicCurve& c) { return c.arc_length() > longest; });
  const ConnectionTrial trial(
      field, WholeSpace(), from, to,
      {.step = 0.2, .max_length = longest, .start = {.chord_share = 0.1}, .roulette_after = 4});
  const int estimates = is_night ? 100000 : 8000;
  const Moments moments = estimated(trial, estimates, 83);
  check_sums(moments, estimates, exact, is_night ? 0.02 : 0.065);
  CHECK(moments.statistics.roulette_terminations > estimates / 20);
}

TEST_CASE("nightly: connection sums: the mean of f K is the sum of f over four curves, to 0.2 %") {
  check_four_curves(600'000, 0.002);
}

}  // namespace flatspeckle::grin::tests::test_connection_sums
