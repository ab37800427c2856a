#pragma once

#include <map>
#include <memory>
#include <mutex>
#include <string>

#include "apps/sweep/point_store.h"
#include "core/run/runner.h"

namespace flatspeckle::apps {

/// Runs of a sweep as a pool takes them: each goes on from where it was cut off, if it was, and
/// ends in the store's journal. Those that are finished need no work.
class SweepWork {
 public:
  /// The runs of this share. store: nullptr of ranks that only compute.
  SweepWork(const Sweep& sweep, PointStore* store);

  RunList list();
  /// After the pool has stopped.
  void save_unfinished();

 private:
  struct Open {
    SweepRun run;
    RunState state;
    std::string started;
  };

  std::optional<OpenRun> open(std::size_t run);
  void ended(std::size_t run);
  void save(std::size_t run);
  Open& find(std::size_t run);

  const Sweep& sweep_;
  PointStore* store_;
  ScatteredRuns runs_;
  std::mutex mutex_;
  std::map<std::size_t, std::unique_ptr<Open>> open_;
};

}  // namespace flatspeckle::apps
