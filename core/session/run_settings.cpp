#include "core/session/run_settings.h"

namespace flatspeckle {

namespace {

constexpr const char* group = "Run";

}  // namespace

void add_output_key(Keys& keys, RunSettings& run, const std::string& what) {
  keys.group(group);
  keys.add("out", run.out, what).no_file();
}

void add_seed_key(Keys& keys, RunSettings& run, const std::string& what) {
  keys.group(group);
  keys.add("seed", run.seed, what).not_negative();
}

void add_thread_key(Keys& keys, RunSettings& run) {
  keys.group(group);
  keys.add("threads", run.threads, "Number of threads (0: one per core)").from(0, 1024).effort();
}

void add_run_keys(Keys& keys, RunSettings& run) {
  add_output_key(keys, run);
  add_seed_key(keys, run, "Random seed; the same seed and number of samples give the same result");
  keys.add("samples", run.samples, "Stop after this number of light paths or placements")
      .positive()
      .effort();
  keys.add("seconds", run.seconds, "Stop after this number of seconds of wall time")
      .positive()
      .unit("s")
      .effort();
  keys.add("target_error", run.target_error,
           "Stop at this relative error; the default is 0.02 (2 %) if no other stop criterion is "
           "given")
      .between(0, 1)
      .effort();
  add_thread_key(keys, run);
  keys.add("resume", run.resume,
           "Continue the run in the file --out, if it exists; a finished run is extended if the "
           "stop criteria given now require more")
      .effort();
  keys.add("keep_state", run.keep_state,
           "Keep the sums from which a finished run can be extended even if they exceed 16 MB; "
           "smaller sums are always kept")
      .effort();
}

int threads_of(const Keys& keys, const RunSettings& run) {
  const auto threads = static_cast<int>(keys.read(run.threads));
  return threads > 0 ? threads : default_threads();
}

std::uint64_t seed_of(const Keys& keys, const RunSettings& run) {
  return static_cast<std::uint64_t>(keys.read(run.seed));
}

StopRule stop_rule(const Keys& keys, const RunSettings& run,
                   const std::optional<std::int64_t>& own_samples) {
  StopRule stop;
  if (const auto& samples = keys.read(own_samples))
    stop.samples = static_cast<std::uint64_t>(*samples);
  stop.seconds = keys.read(run.seconds);
  stop.target_error = keys.read(run.target_error);
  if (!stop.samples && !stop.seconds && !stop.target_error)
    stop.target_error = default_target_error;
  return stop;
}

StopRule stop_rule(const Keys& keys, const RunSettings& run) {
  return stop_rule(keys, run, run.samples);
}

}  // namespace flatspeckle
