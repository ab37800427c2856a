#pragma once

#include <cstdint>
#include <string>

#include "apps/command_line.h"
#include "core/run/runner.h"

namespace flatspeckle::apps {

/// How long to run, on what, and where the result goes.
struct RunSettings {
  std::string out;
  std::int64_t seed = 1;
  std::optional<std::int64_t> samples;
  std::optional<double> seconds, target_error;
  int threads = 0;
  bool resume = false;
};

void add_output_option(Options& options, RunSettings& settings);
void add_thread_option(Options& options, RunSettings& settings);
void add_run_options(Options& options, RunSettings& settings);

/// The number of threads that is meant. Throws InputError.
int threads_of(const RunSettings& settings);

constexpr double default_target_error = 0.02;

/// Checks the settings; without a stop rule a target error of 2 % is set. Throws InputError.
StopRule stop_rule(const RunSettings& settings);
/// The same with a number of samples that has a key of its own.
StopRule stop_rule(const RunSettings& settings, const std::string& samples_key,
                   const std::optional<std::int64_t>& samples);
std::uint64_t seed_of(const RunSettings& settings);

}  // namespace flatspeckle::apps
