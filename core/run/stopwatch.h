#pragma once

#include <chrono>
#include <ctime>

namespace flatspeckle {

inline double cpu_seconds(clockid_t clock) {
  timespec t{};
  clock_gettime(clock, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

/// CPU seconds of the calling thread. Exact, where the clock of the whole process knows of other
/// threads only what the scheduler last wrote down.
inline double thread_cpu_seconds() {
  return cpu_seconds(CLOCK_THREAD_CPUTIME_ID);
}
/// Of all threads, since the program began.
inline double process_cpu_seconds() {
  return cpu_seconds(CLOCK_PROCESS_CPUTIME_ID);
}

/// Wall-clock seconds since construction, plus an offset.
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
