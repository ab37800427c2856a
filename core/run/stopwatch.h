#pragma once

#include <chrono>
#include <ctime>

namespace flatspeckle {

inline double cpu_seconds(clockid_t clock) {
  timespec t{};
  clock_gettime(clock, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

/// Returns the CPU seconds of the calling thread. This time is exact, whereas process_cpu_seconds()
/// counts the time of other running threads only up to their last update by the scheduler.
inline double thread_cpu_seconds() {
  return cpu_seconds(CLOCK_THREAD_CPUTIME_ID);
}
/// Returns the CPU seconds of all threads since the program began.
inline double process_cpu_seconds() {
  return cpu_seconds(CLOCK_PROCESS_CPUTIME_ID);
}

/// Clock that measures wall-clock seconds since its construction, plus an offset.
class Stopwatch {
 public:
  explicit Stopwatch(double offset = 0) : offset_(offset) {}

  double seconds() const {
    return offset_ + std::chrono::duration<double>(Clock::now() - start_).count();
  }

 private:
  using Clock = std::chrono::steady_clock;

  Clock::time_point start_ = Clock::now();
  double offset_;
};

}  // namespace flatspeckle
