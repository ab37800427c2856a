// Prints the long runs that serve as references of error curves.
//
//   bench_error_table [CPU seconds of each [name ...]] > data/error_references.txt
#include <cstdio>
#include <cstdlib>
#include <string>
#include <vector>

#include <omp.h>

#include "bench/error/error_modules.h"

using namespace flatspeckle;
using namespace flatspeckle::bench;

namespace {

constexpr std::uint64_t seed = 1'000'000;  // no curve uses this seed

void print(const LongRun& run, double cpu_seconds) {
  ErrorTrial trial = run.trial(seed);
  // The stopping criterion is not used.
  trial.batches.relative_error = [](const GroupedSums&) { return 1.0; };
  RunState state{GroupedSums(trial.batches.size), {}};
  RunOptions options;
  for (std::uint64_t batches = 256; state.cpu_s < cpu_seconds; batches += batches / 4) {
    options.stop.samples =
        static_cast<std::uint64_t>(static_cast<double>(batches) * trial.batches.samples_per_batch);
    run_batches(trial.batches, options, state);
  }
  const Estimate estimate = jackknife(state.sums, trial.values);
  std::printf("%s|%.3g|%s, %.3g samples\n", run.name.c_str(), relative_error(estimate),
              run.how.c_str(), state.sums.total_samples());
  for (const Complex& value : estimate.value)
    std::printf("%.6g %.6g\n", value.real(), value.imag());
  std::fflush(stdout);
}

bool is_wanted(const std::string& name, int argc, char** argv) {
  for (int i = 2; i < argc; ++i)
    if (name == argv[i]) return true;
  return argc < 3;
}

}  // namespace

int main(int argc, char** argv) {
  omp_set_num_threads(1);  // the batches themselves run in parallel
  const double cpu_seconds = argc > 1 ? std::atof(argv[1]) : 600;
  std::printf("# by bench_error_table %g: references of error curves\n", cpu_seconds);
  for (const auto& runs : {box_long_runs(), power_long_runs(), render_long_runs()})
    for (const LongRun& run : runs)
      if (is_wanted(run.name, argc, argv)) print(run, cpu_seconds);
}
