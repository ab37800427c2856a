#include <cmath>
#include <random>

#include <doctest/doctest.h>

#include "core/numbers/statistics.h"
#include "grin/render/pictures/render_job.h"

namespace flatspeckle::grin::tests::test_picture_errors {

namespace {

constexpr PixelGrid grid{12, 10};
constexpr int batches = 256;
constexpr double strong = 3000;

/// Expected numbers of contributions of a pixel: of size 1, and strong ones.
struct Expected {
  double weak, strong;
};

template <typename Mean>
Estimate picture(const Mean& mean, std::mt19937_64& random) {
  const auto pixels = static_cast<std::size_t>(grid.count());
  GroupedSums sums(pixels);
  std::vector<Complex> batch(pixels);
  for (int number = 0; number < batches; ++number) {
    for (std::size_t i = 0; i < pixels; ++i) {
      const auto draw = [&](double expected) {
        return std::poisson_distribution<int>(expected / batches)(random);
      };
      batch[i] = draw(mean(i).weak) + strong * draw(mean(i).strong);
    }
    sums.add(1.0 / batches, batch);
  }
  Estimate found = jackknife(sums, sample_mean, few_of_pixels);
  bound_errors(found, grid);
  return found;
}

double truth(const Expected& mean) {
  return mean.weak + strong * mean.strong;
}

struct Coverage {
  double marked = 0, unmarked = 0;          ///< shares of their pixels within two errors
  double of_unmarked = 0, pixels_seen = 0;  ///< how many are not marked; all
};

template <typename Mean>
Coverage coverage(const Mean& mean, int pictures) {
  std::mt19937_64 random(1);
  Coverage found;
  double marked = 0;
  for (int k = 0; k < pictures; ++k) {
    const Estimate estimate = picture(mean, random);
    for (std::size_t i = 0; i < estimate.value.size(); ++i) {
      const bool within = std::abs(estimate.value[i] - truth(mean(i))) <= 2 * estimate.error[i];
      (estimate.rare[i] ? marked : found.of_unmarked) += 1;
      (estimate.rare[i] ? found.marked : found.unmarked) += within;
    }
  }
  found.pixels_seen = marked + found.of_unmarked;
  found.marked /= std::max(marked, 1.0);
  found.unmarked /= std::max(found.of_unmarked, 1.0);
  return found;
}

}  // namespace

TEST_CASE("pixels that a few paths light are marked, and their errors are upper bounds") {
  const auto uneven = [](std::size_t i) { return Expected{0.5 + static_cast<double>(i % 7), 0}; };
  const Coverage few = coverage(uneven, 40);
  CHECK(few.of_unmarked == 0);
  CHECK(few.marked > 0.95);
}

TEST_CASE("what rare strong paths find in some pixels is not believed to be missing in others") {
  // a strong one lights every fifth pixel: the others are far too dark, and look sure of it
  const auto even = [](std::size_t) { return Expected{100, 0.2}; };
  const Coverage strong_ones = coverage(even, 40);
  CHECK(strong_ones.marked > 0.95);
  CHECK(strong_ones.of_unmarked < 0.1 * strong_ones.pixels_seen);
}

TEST_CASE("strong paths that light all pixels alike are known together") {
  // one pixel alone tells too little of them
  const auto even = [](std::size_t) { return Expected{100, 20}; };
  const Coverage shared = coverage(even, 40);
  CHECK(shared.of_unmarked > 0.9 * shared.pixels_seen);
  CHECK(shared.unmarked > 0.92);
}

TEST_CASE("where many paths have been errors stay as they are") {
  const Coverage many = coverage([](std::size_t) { return Expected{2e5, 0}; }, 10);
  CHECK(many.of_unmarked == many.pixels_seen);
  CHECK(many.unmarked > 0.93);
  CHECK(many.unmarked < 0.98);
}

}  // namespace flatspeckle::grin::tests::test_picture_errors
