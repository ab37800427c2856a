#pragma once

#include "apps/command_line.h"

namespace flatspeckle::apps {

/// Exit statuses (README).
enum ExitStatus : int {
  done = 0,
  bad_input = 2,
  error_not_reached = 3,
  io_failed = 4,
  row_failed = 5,  ///< a row of a benchmark; the result is written
  interrupted_resumable = 75,
  interrupted_for_good = 130  ///< nothing written, nothing to resume
};

/// Each parses its own arguments, runs, and writes its result file.
int place(const Arguments& arguments);
int solve(const Arguments& arguments);
int covariance(const Arguments& arguments);
int flux(const Arguments& arguments);
int validate(const Arguments& arguments);
int sweep(const Arguments& arguments);
int merge(const Arguments& arguments);
int field(const Arguments& arguments);
int trace(const Arguments& arguments);
int render(const Arguments& arguments);
int bench(const Arguments& arguments);
int datasets(const Arguments& arguments);

}  // namespace flatspeckle::apps
