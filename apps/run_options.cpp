#include "apps/run_options.h"

#include "apps/key_values.h"
#include "core/error.h"

namespace flatspeckle::apps {

namespace {

constexpr int most_threads = 1024;

}  // namespace

void add_output_option(Options& options, RunSettings& settings) {
  options.add("--out", settings.out, "Result file (HDF5)");
  options.keep_out_of_scene_file("--out");
}

void add_thread_option(Options& options, RunSettings& settings) {
  options.add_with_default("--threads", settings.threads, "Threads; 0: as many as there are cores");
}

void add_run_options(Options& options, RunSettings& settings) {
  add_output_option(options, settings);
  options.add_with_default("--seed", settings.seed,
                           "Seed; the same seed and samples give the same numbers");
  options.add("--samples", settings.samples, "Stop after so many light paths or placements");
  options.add("--seconds", settings.seconds, "Stop after so many seconds");
  options.add("--target_error", settings.target_error,
              "Stop at this relative error (default 0.02 if no other stop is given)");
  add_thread_option(options, settings);
  options.add_flag("--resume", settings.resume,
                   "Go on from the run that --out holds, if there is one");
}

int threads_of(const RunSettings& settings) {
  if (settings.threads < 0) throw InputError("threads", settings.threads, "must not be negative");
  if (settings.threads > most_threads)
    throw InputError("threads", settings.threads,
                     "must be at most " + std::to_string(most_threads));
  return settings.threads > 0 ? settings.threads : default_threads();
}

StopRule stop_rule(const RunSettings& settings, const std::string& samples_key,
                   const std::optional<std::int64_t>& samples) {
  StopRule stop;
  threads_of(settings);  // checks
  if (samples) {
    if (*samples <= 0) throw InputError(samples_key, *samples, "must be positive");
    stop.samples = static_cast<std::uint64_t>(*samples);
  }
  if (settings.seconds) stop.seconds = positive("seconds", *settings.seconds);
  if (settings.target_error) stop.target_error = positive("target_error", *settings.target_error);
  if (stop.target_error.value_or(0) >= 1)
    throw InputError("target_error", *stop.target_error, "must be below 1; 2 % is 0.02");
  if (!stop.samples && !stop.seconds && !stop.target_error)
    stop.target_error = default_target_error;
  return stop;
}

StopRule stop_rule(const RunSettings& settings) {
  return stop_rule(settings, "samples", settings.samples);
}

std::uint64_t seed_of(const RunSettings& settings) {
  if (settings.seed < 0) throw InputError("seed", settings.seed, "must not be negative");
  return static_cast<std::uint64_t>(settings.seed);
}

}  // namespace flatspeckle::apps
