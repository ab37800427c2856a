#pragma once

namespace flatspeckle {

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

}  // namespace flatspeckle
