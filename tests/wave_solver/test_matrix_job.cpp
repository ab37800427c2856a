#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <numeric>
#include <vector>

#include <doctest/doctest.h>

#include "core/numbers/random.h"
#include "core/run/runner.h"
#include "flatland/scene/periodic_placement.h"
#include "wave_solver/periodic/eigenvalue_laws.h"
#include "wave_solver/periodic/matrix_job.h"
#include "wave_solver/periodic/shaped_light.h"

namespace flatspeckle::wave {

namespace {

// Resonant points with a mean free path of 2 wavelengths: k l = 12.6.
Scene points(double width, double depth) {
  SceneSpec spec;
  spec.scatterer = "point";
  spec.width = width;
  spec.depth = depth;
  spec.mean_free_path = 2;
  return make_scene(spec);
}

MatrixJob diffusive(double width, double depth) {
  return matrix_job(points(width, depth), {.shifts = 5, .options = {.tolerance = 1e-10}}, 1);
}

GroupedSums summed(const MatrixJob& job, std::uint64_t placements) {
  RunState state;
  state.sums = GroupedSums(job.batches.size);
  run_to_end(job.batches, {.stop = {.samples = placements}}, state);
  return state.sums;
}

}  // namespace

TEST_CASE("matrix statistics: bimodal law contains all eigenvalues and the conductance") {
  constexpr std::size_t channels = 60, bins = 4000;
  const auto counts = bimodal_counts(4, channels, bins);
  double g = 0;
  for (std::size_t i = 0; i < bins; ++i) g += counts[i] * (static_cast<double>(i) + 0.5) / bins;
  CHECK(std::accumulate(counts.begin(), counts.end(), 0.0) == doctest::Approx(channels));
  CHECK(g == doctest::Approx(4).epsilon(0.01));
}

// Filtering with random matrices keeps the fraction (kept / channels)^2 of the conductance.
TEST_CASE(
    "matrix statistics: law of filtered matrices contains all eigenvalues and the conductance") {
  constexpr std::size_t channels = 60, kept = 24, bins = 100;
  const auto counts = filtered_counts(15, channels, kept, bins);
  double g = 0;
  for (std::size_t i = 0; i < bins; ++i) g += counts[i] * (static_cast<double>(i) + 0.5) / bins;
  CHECK(std::accumulate(counts.begin(), counts.end(), 0.0) == doctest::Approx(kept));
  CHECK(g == doctest::Approx(15 * 0.16).epsilon(0.03));
  CHECK(counts[60] < 0.01);  // no eigenvalue is near 1
}

// The conjugated light is sent back by the matrix of the light on the back, without reciprocity.
// Conjugation reverses k_x: channel b becomes channel n - 1 - b.
TEST_CASE("matrix statistics: conjugated light returns as through the back of the same slab") {
  constexpr double width = 12.3;
  constexpr std::size_t n = 25, recorded = 9;
  const Scene scene = points(width, 5);
  const MatrixJob job = matrix_job(scene, {.shifts = 1, .conjugated_fraction = {0.35}}, 1);
  RandomStream random(1, static_cast<std::uint64_t>(Stream::placement), 0);
  const auto slab =
      scattering_matrix(draw_periodic_placement(scene, random), scene.k, {width, 0}, {});
  REQUIRE(slab.channels.size() == n);
  const auto forth = slab.quarter(false, true), back = slab.quarter(true, false);
  double original = 0, all = 0;
  for (std::size_t a = 0; a < n; ++a)
    for (std::size_t c = 0; c < n; ++c) {
      Complex field = 0;
      for (std::size_t b = (n - recorded) / 2; b < (n + recorded) / 2; ++b)
        field += back[c + n * (n - 1 - b)] * std::conj(forth[b + n * a]);
      all += std::norm(field);
      if (c == n - 1 - a) original += std::norm(field);
    }
  GroupedSums sums(job.batches.size);
  std::vector<Complex> first(job.batches.size);
  job.batches.run(0, first);
  sums.add(1, first);
  const auto found = matrix_statistics(job, sums);
  CHECK(found.recorded[0] == doctest::Approx(double{recorded} / n));
  CHECK(found.conjugation.value[0].real() == doctest::Approx(original / all).epsilon(1e-6));
}

TEST_CASE("matrix statistics: focusing by segments agrees with theory for Gaussian amplitudes") {
  const MatrixJob job = matrix_job(points(20.3, 12), {.shifts = 1, .segments = {1, 4, 13, 41}}, 1);
  REQUIRE(job.channels.size() == 41);
  const auto found = matrix_statistics(job, summed(job, 40));
  const Estimate& focus = found.segment_focus;
  CHECK(focus.value[0].real() == doctest::Approx(1));
  CHECK(focus.value[3].real() == doctest::Approx(found.focus.value[0].real()));
  for (const std::size_t i : {1, 2, 3})
    CHECK(std::abs(focus.value[i].real() - found.focus_theory[i + 1]) < 4 * focus.error[i]);
}

TEST_CASE("expected focusing and conjugation: equal channels agree with closed forms") {
  const std::vector<double> equal(60, 0.1);
  CHECK(expected_focus(equal, 12) == doctest::Approx(1 + std::numbers::pi / 4 * 11));
  // For all channels: sum tau^2 is 2 g / 3 = 4, and sum T_a^2 is 0.6, increased by fluctuations.
  CHECK(expected_conjugation(equal, 60) == doctest::Approx(0.6 * (1 + 2.8 / 36 + 1 / 60.0) / 4));
  // With T = 1/3 no correlation is left: independent Gaussian elements have sum tau^2 = 2 g / 3.
  const std::vector<double> open(60, 1.0 / 3);
  CHECK(expected_conjugation(open, 60) == doctest::Approx(61.0 / 120));
  CHECK(expected_conjugation(open, 15) == doctest::Approx(16.0 / 75));
}

TEST_CASE("nightly: transmission eigenvalues of a diffusive slab follow Dorokhov's law") {
  const auto job = diffusive(60.3, 30);
  const auto sums = summed(job, 40);
  const auto found = matrix_statistics(job, sums);
  const std::size_t bins = job.settings.eigenvalue_bins;
  const double g = found.conductance.value[0].real();
  const auto expected = bimodal_counts(g, job.channels.size(), bins);
  double chi_square = 0;
  for (std::size_t i = 1; i < bins; ++i) {
    const double difference = found.eigenvalues.value[i].real() - expected[i];
    chi_square += std::pow(difference / found.eigenvalues.error[i], 2);
  }
  CHECK(chi_square < 44);  // 19 bins: exceeded with a probability of 1e-3
  CHECK(found.largest.value[0].real() > 0.98);
  CHECK(found.power.off < 1e-9);
}

}  // namespace flatspeckle::wave
