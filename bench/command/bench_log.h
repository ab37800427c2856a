#pragma once

#include <cstddef>
#include <mutex>
#include <string>

#include "core/run/stopwatch.h"

namespace flatspeckle::apps {

/// A line on standard output for each part of a benchmark that is finished, and on a terminal one
/// on standard error that tells how many are not. For any thread.
class BenchLog {
 public:
  /// parts: what they are called.
  BenchLog(std::size_t count, std::string parts);
  ~BenchLog();

  void finished(const std::string& line);

 private:
  void clear() const;

  std::size_t count_, done_ = 0;
  std::string parts_;
  bool terminal_;
  Stopwatch clock_;
  std::mutex mutex_;
};

}  // namespace flatspeckle::apps
