#pragma once

#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "apps/sweep/sweep_plan.h"
#include "core/run/runner.h"
#include "core/session/shard_folder.h"

namespace flatspeckle::apps {

/// Runs of a sweep as the runner takes them: each goes on from the unfinished file in the folder,
/// if there is one, and ends in a finished one. Those that have one need no work.
class SweepWork {
 public:
  /// Those of `runs`, by their numbers in the plan.
  SweepWork(const SweepPlan& plan, ShardFolder& folder, const ScatteredRuns& runs);

  RunList list();
  /// After the pool has stopped.
  void save_unfinished();

 private:
  struct Open {
    Scene scene;
    Estimation estimation;
    RunState state;
  };

  using Part = ShardFolder::Part;

  bool read_or_set_aside(std::size_t number, Part part,
                         const std::function<void(const ResultReader&)>& reading);
  std::optional<OpenRun> open(std::size_t number);
  void ended(std::size_t number);
  void save(std::size_t number);
  Open& find(std::size_t number);
  void write_made(ResultFile& file, const Open& open, bool converged) const;

  const SweepPlan& plan_;
  ShardFolder& folder_;
  ScatteredRuns runs_;
  std::mutex mutex_;
  std::map<std::size_t, std::unique_ptr<Open>> open_;
};

}  // namespace flatspeckle::apps
