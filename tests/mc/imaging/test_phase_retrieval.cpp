// Phase retrieval of pictures from their autocorrelation.
#include <algorithm>
#include <cmath>
#include <numeric>

#include <doctest/doctest.h>

#include "mc/imaging/recovery/phase_retrieval.h"

namespace flatspeckle::mc::test_phase_retrieval {

namespace {

constexpr std::size_t lags = 100;

/// Renders points as Gaussians.
std::vector<double> picture_of(const std::vector<double>& x,
                               const std::vector<double>& brightness) {
  std::vector<double> picture(lags);
  for (std::size_t i = 0; i < x.size(); ++i)
    for (std::size_t p = 0; p < lags; ++p)
      picture[p] += brightness[i] * std::exp(-std::pow((static_cast<double>(p) - x[i]) / 1.5, 2));
  return picture;
}

std::vector<double> autocorrelation_of(const std::vector<double>& picture) {
  std::vector<double> values(picture.size());
  for (std::size_t lag = 0; lag < values.size(); ++lag)
    for (std::size_t p = lag; p < picture.size(); ++p) values[lag] += picture[p] * picture[p - lag];
  return values;
}

/// Returns the correlation of two lines at the best shift, mirrored or not. The second one may be
/// longer.
double correlation_of(std::vector<double> a, const std::vector<double>& b) {
  a.resize(std::max(a.size(), b.size()));
  return best_alignment(a, b, {1, a.size()}).correlation;
}

}  // namespace

TEST_CASE("phase retrieval: a picture is recovered up to shift and mirroring") {
  const auto truth = picture_of({8, 19, 52}, {1, 3, 2});
  const auto found = retrieved_line(autocorrelation_of(truth), {});
  CHECK(correlation_of(truth, found.picture) > 0.98);
  CHECK(std::reduce(found.picture.begin(), found.picture.end()) == doctest::Approx(1));
  CHECK(*std::min_element(found.picture.begin(), found.picture.end()) >= 0);
}

TEST_CASE("phase retrieval: error reduction lowers the residual, more starts do not raise it") {
  const auto values = autocorrelation_of(picture_of({5, 13, 44, 61}, {1, 1, 1, 1}));
  const PhaseTask one{.starts = 1, .iterations = 200, .sparsity = 0};
  const auto few = retrieved_line(values, one),
             many = retrieved_line(values, {.starts = 8, .iterations = 200, .sparsity = 0});
  REQUIRE(few.residual.size() == 200);
  CHECK(std::is_sorted(few.residual.rbegin(), few.residual.rbegin() + 45));
  CHECK(many.residual.back() <= few.residual.back());
}

TEST_CASE("picture correlation: maximum over shifts and mirroring") {
  const std::vector<double> truth{0, 1, 2, 0, 0, 5}, mirrored{5, 0, 0, 2, 1, 0},
      other{1, 0, 0, 0, 0, 1};
  CHECK(correlation_of(truth, mirrored) == doctest::Approx(1));
  CHECK(correlation_of(truth, other) < 0.95);
}

TEST_CASE("picture alignment: shift and rotation by 180 degrees are undone") {
  const PictureSize size{4, 5};
  std::vector<double> truth(size.pixels());
  truth[6] = 1, truth[7] = 2, truth[12] = 4;
  const Alignment rotate{1, true, 1, -1}, shift{1, false, 1, 1};
  for (const Alignment& move : {rotate, shift}) {
    const auto moved = move.applied(truth, size);
    const Alignment back = best_alignment(truth, moved, size);
    CHECK(back.correlation == doctest::Approx(1));
    CHECK(back.rotated == move.rotated);
    CHECK(back.applied(moved, size) == truth);
  }
}

}  // namespace flatspeckle::mc::test_phase_retrieval
