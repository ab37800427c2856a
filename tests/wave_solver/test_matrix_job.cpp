#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <numeric>
#include <vector>

#include <doctest/doctest.h>

#include "core/run/runner.h"
#include "wave_solver/periodic/eigenvalue_laws.h"
#include "wave_solver/periodic/matrix_job.h"

namespace flatspeckle::wave {

namespace {

// Resonant points with a mean free path of 2 wavelengths: k l = 12.6.
MatrixJob diffusive(double width, double depth) {
  SceneSpec spec;
  spec.scatterer = "point";
  spec.width = width;
  spec.depth = depth;
  spec.mean_free_path = 2;
  return matrix_job(make_scene(spec), {.shifts = 5, .options = {.tolerance = 1e-10}}, 1);
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
