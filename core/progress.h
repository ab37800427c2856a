#pragma once

#include <string>

#include "core/runner.h"

namespace flatspeckle {

/// Says on standard error how a run gets on: a line that renews itself on a terminal, a line every
/// ten seconds elsewhere. Silent without a label.
class Progress {
 public:
  /// unit: what the samples are called.
  Progress(std::string label, const StopRule& stop, std::string unit = "samples");

  /// samples and wall seconds so far, of which `new_samples` in the `new_wall` seconds of this run.
  void update(double samples, double new_samples, double wall, double new_wall, double error);
  /// Leaves the end of the run standing on its own line.
  void finish(double samples, double wall, double error);

 private:
  const char* line_start() const;
  double seconds_left(double samples, double rate, double wall, double error) const;

  std::string label_, unit_;
  StopRule stop_;
  bool terminal_;
  double last_shown_ = 0;
};

}  // namespace flatspeckle
