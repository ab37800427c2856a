#pragma once

#include <map>
#include <memory>
#include <mutex>
#include <vector>

#include "apps/experiments/point_store.h"
#include "core/run/runner.h"

namespace flatspeckle::apps {

/// Points of a sweep as runs of a pool: each goes on from its unfinished file, if there is one, and
/// ends in the store's journal. Those that are finished need no work.
class ExperimentWork {
 public:
  /// Of the points of its share. store: nullptr of ranks that only compute.
  ExperimentWork(const ExperimentSweep& sweep, PointStore* store);

  RunList list();
  /// After the pool has stopped.
  void save_unfinished();

 private:
  struct Open {
    std::unique_ptr<Experiment> experiment;
    PlannedExperiment planned;
    RunState state;
    std::string started;
  };

  std::optional<OpenRun> open(std::size_t point);
  void ended(std::size_t point);
  void save(std::size_t point);
  Open& find(std::size_t point);

  const ExperimentSweep& sweep_;
  PointStore* store_;
  ScatteredRuns points_;
  std::mutex mutex_;
  std::map<std::size_t, std::unique_ptr<Open>> open_;
};

}  // namespace flatspeckle::apps
