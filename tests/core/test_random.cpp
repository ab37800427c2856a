#include <cmath>
#include <vector>

#include <boost/math/distributions/chi_squared.hpp>
#include <doctest/doctest.h>

#include "core/numbers/random.h"

namespace flatspeckle::test_random {

TEST_CASE("random stream: depends only on seed, stream, batch and draw") {
  RandomStream a(7, 1, 5), b(7, 1, 5);
  for (int i = 0; i < 100; ++i) CHECK(a.bits() == b.bits());
  const auto first = [](std::uint64_t seed, std::uint64_t stream, std::uint64_t batch) {
    return RandomStream(seed, stream, batch).bits();
  };
  CHECK(first(7, 1, 5) != first(8, 1, 5));
  CHECK(first(7, 1, 5) != first(7, 2, 5));
  CHECK(first(7, 1, 5) != first(7, 1, 6));
}

TEST_CASE("random bits: agree with known answers of Threefry4x64-20") {
  // Known answers of Random123 (kat_vectors): counter 0, key 0.
  RandomStream zero(0, 0, 0);
  CHECK(zero.bits() == 0x09218ebde6c85537ULL);
  CHECK(zero.bits() == 0x55941f5266d86105ULL);
  CHECK(zero.bits() == 0x4bd25e16282434dcULL);
  CHECK(zero.bits() == 0xee29ec846bd2e40bULL);
}

TEST_CASE("uniform numbers: the extreme bit patterns are within (0, 1)") {
  CHECK(RandomStream::uniform(0) == 0x1p-54);
  CHECK(RandomStream::uniform(~std::uint64_t{0}) == 1 - 0x1p-53);
}

TEST_CASE("random stream: a number put back is next, later ones are unchanged") {
  RandomStream fresh(7, 1, 5), drawn(7, 1, 5), plain(7, 1, 5);
  fresh.put_back(0.3);
  CHECK(fresh.uniform() == doctest::Approx(0.3).epsilon(1e-15));
  CHECK(fresh.uniform() == plain.uniform());
  drawn.uniform();
  for (int i = 0; i < 9; ++i) {
    drawn.put_back(0.7);
    CHECK(drawn.uniform() == doctest::Approx(0.7).epsilon(1e-15));
    CHECK(drawn.uniform() == plain.uniform());
  }
}

TEST_CASE("uniform numbers: uniform within and across batches (chi-squared)") {
  constexpr int bins = 64, draws = 200'000;
  std::vector<double> within(bins), across(bins);
  RandomStream stream(3, 1, 0);
  double sum = 0;
  for (int i = 0; i < draws; ++i) {
    const double u = stream.uniform();
    REQUIRE(u > 0);
    REQUIRE(u < 1);
    sum += u;
    ++within[static_cast<std::size_t>(u * bins)];
    const double first = RandomStream(3, 1, static_cast<std::uint64_t>(i)).uniform();
    ++across[static_cast<std::size_t>(first * bins)];
  }
  CHECK(sum / draws == doctest::Approx(0.5).epsilon(4 / std::sqrt(12.0 * draws) / 0.5));
  const double limit = quantile(complement(boost::math::chi_squared(bins - 1), 1e-4));
  for (const auto* counts : {&within, &across}) {
    double chi2 = 0;
    for (double count : *counts)
      chi2 += std::pow(count - 1.0 * draws / bins, 2) / (1.0 * draws / bins);
    CHECK(chi2 < limit);
  }
}

}  // namespace flatspeckle::test_random
