#pragma once

#include <chrono>
#include <ctime>

namespace flatspeckle {

/// Elapsed wall-clock and process CPU seconds (all threads) since construction, plus an offset.
class Stopwatch {
 public:
  explicit Stopwatch(double wall_offset = 0, double cpu_offset = 0)
      : wall_offset_(wall_offset), cpu_offset_(cpu_offset) {}

  double wall() const {
    return wall_offset_ + std::chrono::duration<double>(Clock::now() - wall_start_).count();
  }
  double cpu() const { return cpu_offset_ + process_cpu() - cpu_start_; }

 private:
  using Clock = std::chrono::steady_clock;

  static double process_cpu() {
    timespec t{};
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
    return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
  }

  Clock::time_point wall_start_ = Clock::now();
  double cpu_start_ = process_cpu();
  double wall_offset_, cpu_offset_;
};

}  // namespace flatspeckle
