#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "core/keys/keys.h"
#include "core/run/runner.h"

namespace flatspeckle {

/// How long to run, on what, and where the result goes.
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
/// All of them, for what batches make.
void add_run_keys(Keys& keys, RunSettings& run);

/// The number of threads that is meant, and the seed.
int threads_of(const Keys& keys, const RunSettings& run);
std::uint64_t seed_of(const Keys& keys, const RunSettings& run);

inline constexpr double default_target_error = 0.02;

/// Without a stop rule a target error of 2 % is set. own_samples: a number of samples with a key of
/// its own, which takes the place of `samples`.
StopRule stop_rule(const Keys& keys, const RunSettings& run);
StopRule stop_rule(const Keys& keys, const RunSettings& run,
                   const std::optional<std::int64_t>& own_samples);

}  // namespace flatspeckle
