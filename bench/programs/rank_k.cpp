// Full covariance over 360 views x 4 lights, box of 20 x 20, mean free path 10, isotropic, reversed
// paths: seconds per path beside those of as many columns (fields handed to the accumulator) in
// Hermitian rank-k updates (zherk) of a matrix of the same size, in turn on one thread, medians;
// the efficiency 1 / (relative error^2 x CPU seconds) over that of scores at every scatterer; and
// the smallest eigenvalue.
//
//   bench_rank_k [rounds]
#include <algorithm>
#include <cmath>
#include <complex>
#include <cstdio>
#include <cstdlib>
#include <numbers>
#include <vector>

#define lapack_complex_double std::complex<double>
#define lapack_complex_float std::complex<float>
#include <cblas.h>
#include <lapacke.h>

#include "bench/measure/contest.h"
#include "bench/measure/median.h"
#include "core/run/stopwatch.h"
#include "flatland/scene/scene.h"
#include "mc/paths/estimators/covariance_estimator.h"

using namespace flatspeckle;
using namespace flatspeckle::bench;

namespace {

constexpr std::uint64_t seed = 1;

Scene isotropic_box() {
  SceneSpec spec;
  spec.width = spec.depth = 20;
  spec.scatterer = "hg";
  spec.mean_free_path = 10;
  spec.covariance = "full";
  spec.light_angles = {0, 0.1, 0.2, 0.3};
  spec.view_angles.clear();
  for (int v = 0; v < 360; ++v) spec.view_angles.push_back(std::numbers::pi * (v - 179.5) / 180);
  return make_scene(spec);
}

/// Counts what an accumulator is given.
class Counter : public mc::Accumulator {
 public:
  void add(double, std::span<const Complex>) override { ++fields; }
  double fields = 0;
};

double columns_per_path(const Scene& scene, const mc::Plan& plan) {
  const auto batches = mc::path_batches(scene, plan, seed);
  constexpr int count = 40;
  Counter counter;
  for (int number = 0; number < count; ++number) batches(number, counter);
  return counter.fields / static_cast<double>(count * plan.paths_per_batch);
}

/// Seconds per column of zherk, `width` columns at once.
class Updates {
 public:
  Updates(std::size_t channels, int width)
      : n_(static_cast<blasint>(channels)),
        width_(width),
        columns_(channels * width, Complex(0.5, -0.5)),
        matrix_(channels * channels) {}

  double seconds_per_column() {
    constexpr int columns = 1024;
    const double start = thread_cpu_seconds();
    for (int done = 0; done < columns; done += width_)
      cblas_zherk(CblasColMajor, CblasLower, CblasNoTrans, n_, width_, 1, columns_.data(), n_, 1,
                  matrix_.data(), n_);
    return (thread_cpu_seconds() - start) / columns;
  }

 private:
  blasint n_;
  int width_;
  std::vector<Complex> columns_, matrix_;
};

struct Timing {
  double path, column;
  int width;
};

Timing time_both(const FieldJob& job, std::size_t channels, int rounds) {
  const std::vector<int> widths = {64, 128, 256, 512};
  std::vector<Updates> updates;
  for (int width : widths) updates.emplace_back(channels, width);
  std::vector<double> path;
  std::vector<std::vector<double>> column(widths.size());
  std::vector<Complex> sums(job.batches.size);
  for (int round = 0; round < rounds; ++round) {
    const double start = thread_cpu_seconds();
    constexpr int batches = 2;
    for (int number = 0; number < batches; ++number)
      job.batches.run(batches * round + number, sums);
    path.push_back((thread_cpu_seconds() - start) / (batches * job.batches.samples_per_batch));
    for (std::size_t w = 0; w < widths.size(); ++w)
      column[w].push_back(updates[w].seconds_per_column());
  }
  Timing timing{median(path), INFINITY, 0};
  for (std::size_t w = 0; w < widths.size(); ++w)
    if (median(column[w]) < timing.column)
      timing.column = median(column[w]), timing.width = widths[w];
  return timing;
}

/// Smallest over largest.
double eigenvalue_ratio(const std::vector<Complex>& lower_rows, std::size_t n) {
  std::vector<Complex> matrix(n * n);
  std::size_t entry = 0;
  for (std::size_t a = 0; a < n; ++a)
    for (std::size_t b = 0; b <= a; ++b) matrix[a + b * n] = lower_rows[entry++];
  std::vector<double> values(n);
  const auto order = static_cast<lapack_int>(n);
  LAPACKE_zheevd(LAPACK_COL_MAJOR, 'N', 'L', order, matrix.data(), order, values.data());
  return values.front() / values.back();
}

}  // namespace

int main(int argc, char** argv) {
  const int rounds = argc > 1 ? std::atoi(argv[1]) : 5;
  openblas_set_num_threads(1);
  const Scene scene = isotropic_box();
  const std::size_t channels = scene.request.channels.size();
  mc::Plan plan = mc::make_plan(scene, mc::ReversedPaths::yes);
  plan.paths_per_batch = 1000;  // of which 16 are needed for an error
  mc::Plan every = plan;
  every.score_level = 0;
  std::vector<Contender> pair = {{"every scatterer scores", mc::covariance_job(scene, every, seed)},
                                 {"as planned", mc::covariance_job(scene, plan, seed + 1)}};
  std::printf("%zu channels: %s\n%-24s %8s %8s %22s %6s\n", channels, plan.describe().c_str(), "",
              "ms/path", "columns", "zherk, ms/column", "ratio");
  const std::vector<mc::Plan> plans = {every, plan};
  for (std::size_t i = 0; i < pair.size(); ++i) {
    const double columns = columns_per_path(scene, plans[i]);
    const Timing timing = time_both(pair[i].job, channels, rounds);
    std::printf("%-24s %8.4f %8.3f %9.4f (%3d at once) %6.2f\n", pair[i].name.c_str(),
                1e3 * timing.path, columns, 1e3 * timing.column, timing.width,
                timing.path / (columns * timing.column));
    std::fflush(stdout);
  }
  compete(pair, rounds, 1);
  const Outcome outcome = compare(pair[1], pair[0]);
  std::printf(
      "efficiency of the plan over scores at every scatterer: %.2f x/ %.2f; the two differ by %.2f "
      "standard errors, RMS over the entries\n",
      outcome.median, std::exp(outcome.log_error), outcome.rms_sigma);
  const double smallest = eigenvalue_ratio(pair[1].sums.total(), channels);
  std::printf("smallest eigenvalue %.2g of the largest\n", smallest);
  return smallest >= -1e-12 ? 0 : 1;
}
