#include <cmath>
#include <random>

#include <doctest/doctest.h>

#include "core/numbers/statistics.h"
#include "grin/render/pictures/render_job.h"

namespace flatspeckle::grin::tests::test_picture_errors {

namespace {

constexpr PixelGrid grid{12, 10};
constexpr int usual_batches = 256;
constexpr double strong = 3000;

/// Expected numbers of contributions to a pixel: weak ones of size 1, and strong ones.
struct Expected {
  double weak, strong;
};

template <typename Mean>
Estimate picture(const Mean& mean, int batches, std::mt19937_64& random) {
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
  Estimate found = jackknife(sums, sample_mean, few_of_pixels(sums.groups()));
  bound_errors(found, grid);
  return found;
}

double truth(const Expected& mean) {
  return mean.weak + strong * mean.strong;
}

struct Coverage {
  double undersampled = 0, resolved = 0;       ///< fractions of their pixels within two errors
  double resolved_pixels = 0, all_pixels = 0;  ///< numbers of resolved and of all pixels
};

template <typename Mean>
Coverage coverage(const Mean& mean, int pictures, int batches = usual_batches) {
  std::mt19937_64 random(1);
  Coverage found;
  double undersampled = 0;
  for (int k = 0; k < pictures; ++k) {
    const Estimate estimate = picture(mean, batches, random);
    for (std::size_t i = 0; i < estimate.value.size(); ++i) {
      const bool within = std::abs(estimate.value[i] - truth(mean(i))) <= 2 * estimate.error[i];
      (estimate.rare[i] ? undersampled : found.resolved_pixels) += 1;
      (estimate.rare[i] ? found.undersampled : found.resolved) += within;
    }
  }
  found.all_pixels = undersampled + found.resolved_pixels;
  found.undersampled /= std::max(undersampled, 1.0);
  found.resolved /= std::max(found.resolved_pixels, 1.0);
  return found;
}

}  // namespace

TEST_CASE("pixels of few batches: undersampled where errors exceed 40 %") {
  constexpr int few = 13;
  const Coverage rough = coverage([](std::size_t) { return Expected{4, 0}; }, 10, few);
  CHECK(rough.resolved_pixels < 0.05 * rough.all_pixels);
  CHECK(rough.undersampled > 0.95);
  const Coverage fine = coverage([](std::size_t) { return Expected{60, 0}; }, 10, few);
  CHECK(fine.resolved_pixels == fine.all_pixels);
  CHECK(fine.resolved > 0.9);
}

TEST_CASE("pixels of few paths: undersampled, with errors that are upper bounds") {
  const auto uneven = [](std::size_t i) { return Expected{0.5 + static_cast<double>(i % 7), 0}; };
  const Coverage few = coverage(uneven, 40);
  CHECK(few.resolved_pixels == 0);
  CHECK(few.undersampled > 0.95);
}

TEST_CASE("pixels beside rare strong paths: undersampled, with errors that are upper bounds") {
  // every fifth pixel has a strong contribution; the others are far too dark, with small errors
  const auto even = [](std::size_t) { return Expected{100, 0.2}; };
  const Coverage strong_ones = coverage(even, 40);
  CHECK(strong_ones.undersampled > 0.95);
  CHECK(strong_ones.resolved_pixels < 0.1 * strong_ones.all_pixels);
}

TEST_CASE("pixels of few weak paths beside pixels of many strong ones: undersampled") {
  const auto rim = [](std::size_t i) {
    return static_cast<int>(i) % grid.columns == 0 ? Expected{3, 0.02} : Expected{0, 2e4};
  };
  const Coverage found = coverage(rim, 20);
  const double darker = 1.0 / grid.columns;
  CHECK(found.undersampled > 0.95);
  CHECK(found.resolved_pixels / found.all_pixels == doctest::Approx(1 - darker).epsilon(0.01));
  CHECK(found.resolved > 0.93);
}

TEST_CASE("pixels of few samples behind glass: undersampled if a reflection may be missing") {
  // a sample that is reflected at the glass sees something else than those that are refracted
  constexpr double through = 1.6, reflected = 0.2, reflectance = 0.04;
  constexpr double expected = through + reflectance * (reflected - through);
  std::mt19937_64 random(1);
  for (const int batches : {16, 32, 64}) {
    double pixels = 0, outliers = 0;
    for (int k = 0; k < 20; ++k) {
      GroupedSums sums(static_cast<std::size_t>(grid.count()));
      std::vector<Complex> batch(sums.size());
      for (int number = 0; number < batches; ++number) {
        for (Complex& sample : batch)
          sample = std::bernoulli_distribution(reflectance)(random)
                       ? reflected
                       : std::normal_distribution(through, 1e-3)(random);
        sums.add(1, batch);
      }
      Estimate found = jackknife(sums, sample_mean, few_of_pixels(sums.groups()));
      bound_errors(found, grid);
      for (std::size_t i = 0; i < batch.size(); ++i) {
        pixels += 1;
        outliers += !found.rare[i] && std::abs(found.value[i] - expected) > 4 * found.error[i];
      }
    }
    CAPTURE(batches);
    CHECK(outliers <= 0.002 * pixels);
  }
}

TEST_CASE("strong paths over all pixels: resolved from the pixels together") {
  // a single pixel has too few of them
  const auto even = [](std::size_t) { return Expected{100, 20}; };
  const Coverage shared = coverage(even, 40);
  CHECK(shared.resolved_pixels > 0.9 * shared.all_pixels);
  CHECK(shared.resolved > 0.92);
}

TEST_CASE("pixels of many paths: errors are unchanged") {
  const Coverage many = coverage([](std::size_t) { return Expected{2e5, 0}; }, 10);
  CHECK(many.resolved_pixels == many.all_pixels);
  CHECK(many.resolved > 0.93);
  CHECK(many.resolved < 0.98);
}

}  // namespace flatspeckle::grin::tests::test_picture_errors
