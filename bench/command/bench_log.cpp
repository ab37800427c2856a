#include "bench/command/bench_log.h"

#include <cstdio>
#include <unistd.h>
#include <utility>

namespace flatspeckle::apps {

BenchLog::BenchLog(std::size_t count, std::string parts)
    : count_(count), parts_(std::move(parts)), terminal_(isatty(STDERR_FILENO) == 1) {}

BenchLog::~BenchLog() {
  clear();
}

void BenchLog::clear() const {
  if (terminal_) std::fputs("\r\033[K", stderr);
}

void BenchLog::finished(const std::string& line) {
  const std::lock_guard lock(mutex_);
  ++done_;
  clear();
  std::printf("%s\n", line.c_str());
  std::fflush(stdout);
  if (terminal_)
    std::fprintf(stderr, "bench: %zu of %zu %s, %.0f s", done_, count_, parts_.c_str(),
                 clock_.seconds());
}

}  // namespace flatspeckle::apps
