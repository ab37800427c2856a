#include <limits>
#include <vector>

#include <doctest/doctest.h>

#include "core/error.h"
#include "core/numbers/random.h"
#include "grin/render/transport/transport_counts.h"

namespace flatspeckle::grin::test_film {

namespace {

struct Pictures {
  TimeBins bins;
  std::vector<Complex> timed, steady;

  double of_bin(int pixel, int bin) const { return of_part(pixel, bin + 1); }
  double of_part(int pixel, int part) const { return timed[pixel * bins.sums() + part].real(); }
  double sum(int pixel) const {
    double result = 0;
    for (int part = 0; part < bins.parts(); ++part) result += of_part(pixel, part);
    return result;
  }
  /// Returns the sum over the bins of value times bin centre.
  double moment(int pixel) const {
    const double width = (bins.last - bins.first) / bins.count;
    double result = 0;
    for (int bin = 0; bin < bins.count; ++bin)
      result += of_bin(pixel, bin) * (bins.first + (bin + 0.5) * width);
    return result;
  }
};

Pictures one(const TimeBins& bins, double optical_path) {
  Pictures pictures{bins, std::vector<Complex>(bins.sums()), std::vector<Complex>(1)};
  Film(1, bins, pictures.timed).add(0, 1, optical_path);
  return pictures;
}

}  // namespace

TEST_CASE("film: the sum over the bins is the steady picture, whenever light arrives") {
  constexpr int pixels = 3;
  for (const int count : {1, 2, 7}) {
    const TimeBins bins{2, 5, count};
    Pictures pictures{bins, std::vector<Complex>(pixels * bins.sums()),
                      std::vector<Complex>(pixels)};
    Film timed(pixels, bins, pictures.timed), steady(pixels, {}, pictures.steady);
    RandomStream random(1, 90, count);
    for (int i = 0; i < 10000; ++i) {
      const int pixel = i % pixels;
      const double value = (pixel + 1) * random.uniform();
      timed.add(pixel, value, 1 + 5 * random.uniform());
      steady.add(pixel, value, 0);
    }
    for (int pixel = 0; pixel < pixels; ++pixel) {
      CHECK(pictures.steady[pixel].real() == doctest::Approx((pixel + 1) * 5000 / 3.).epsilon(0.1));
      CHECK(pictures.sum(pixel) == doctest::Approx(pictures.steady[pixel].real()).epsilon(1e-12));
    }
  }
}

TEST_CASE("film: linear splatting keeps the optical path between the first and last bin centres") {
  const TimeBins bins{-1, 3, 8};  // centres at -0.75, -0.25 ... 2.75
  for (const double path : {-0.75, -0.7, -0.25, 0.1, 1.0, 2.74, 2.75}) {
    CAPTURE(path);
    CHECK(one(bins, path).sum(0) == doctest::Approx(1).epsilon(1e-14));
    CHECK(one(bins, path).moment(0) == doctest::Approx(path).epsilon(1e-14));
  }
  const Pictures shared = one(bins, 0.1);  // between 0 - 0.25 and 0 + 0.25
  CHECK(shared.of_bin(0, 1) == doctest::Approx(0.3).epsilon(1e-12));
  CHECK(shared.of_bin(0, 2) == doctest::Approx(0.7).epsilon(1e-12));
}

TEST_CASE("film: light before and after all bins is kept in two outer parts") {
  const TimeBins bins{-1, 3, 8};
  for (const double path : {-1e300, -5.0, -1.0001, std::nan("")})
    CHECK(one(bins, path).of_part(0, 0) == 1);
  for (const double path : {-1.0, -0.8}) CHECK(one(bins, path).of_bin(0, 0) == 1);
  for (const double path : {2.8, 3.0}) CHECK(one(bins, path).of_bin(0, 7) == 1);
  for (const double path : {3.0001, 40.0, 1e300, double{INFINITY}})
    CHECK(one(bins, path).of_part(0, 9) == 1);
}

TEST_CASE("film: moments of the optical path, with bins and without") {
  for (const int count : {1, 8}) {
    const TimeBins bins{-1, 3, count, true};
    const Pictures pictures = one(bins, 7);
    CHECK(pictures.sum(0) == 1);
    CHECK(pictures.of_part(0, bins.parts()) == 7);
    CHECK(pictures.of_part(0, bins.parts() + 1) == 49);
  }
}

TEST_CASE("film: values and derivatives that are not finite are counted and left out") {
  const TimeBins bins{.by_field = 2};
  std::vector<Complex> sums(bins.sums());
  Film film(1, bins, sums);
  TransportCounts counts;
  constexpr double beyond = std::numeric_limits<double>::infinity();
  for (const double value : {2.0, beyond, 0.0 * beyond, -beyond}) {
    deposit(film, counts, 0, value, 0);
    deposit_by_field(film, counts, 0, 1, 3 * value);
  }
  CHECK(counts.lost_values == 6);
  CHECK(sums[0] == 2.0);
  CHECK(sums[bins.first_by_field()] == 0.0);
  CHECK(sums[bins.first_by_field() + 1] == 6.0);
}

}  // namespace flatspeckle::grin::test_film
