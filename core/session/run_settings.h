#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "core/keys/keys.h"
#include "core/run/runner.h"

namespace flatspeckle {

/// Values of the keys of a run: stop criteria, computing resources and result file.
struct RunSettings {
  std::string out;
  std::int64_t seed = 1;
  std::optional<std::int64_t> samples;
  std::optional<double> seconds, target_error;
  std::int64_t threads = 0;
  bool resume = false, keep_state = false;
};

void add_output_key(Keys& keys, RunSettings& run, const std::string& what = "Result file (HDF5)");
void add_seed_key(Keys& keys, RunSettings& run, const std::string& what);
void add_thread_key(Keys& keys, RunSettings& run);
/// Adds the keys of the functions above and those of the stop criteria, for results that are
/// computed in batches.
void add_run_keys(Keys& keys, RunSettings& run);

/// Returns the number of threads to use; if none is given, the number of cores.
int threads_of(const Keys& keys, const RunSettings& run);
std::uint64_t seed_of(const Keys& keys, const RunSettings& run);

inline constexpr double default_target_error = 0.02;

/// Returns the stop rule that the keys give; without any, a target error of 2 %. own_samples:
/// number of samples that is used instead of the key `samples`, from a key of the method.
StopRule stop_rule(const Keys& keys, const RunSettings& run);
StopRule stop_rule(const Keys& keys, const RunSettings& run,
                   const std::optional<std::int64_t>& own_samples);

}  // namespace flatspeckle
