#pragma once

#include <chrono>
#include <ctime>

namespace flatspeckle {

/// CPU seconds of the calling thread. Exact, where the clock of the whole process knows of other
/// threads only what the scheduler last wrote down.
inline double thread_cpu_seconds() {
  timespec t{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
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
