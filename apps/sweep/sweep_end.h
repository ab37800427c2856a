#pragma once

#include <iosfwd>
#include <string>
#include <vector>

#include "apps/sweep/sweep_output.h"
#include "apps/sweep/sweep_plan.h"
#include "core/run/runner.h"
#include "core/session/shard_folder.h"

namespace flatspeckle::apps {

/// The folder beside a sweep's result in which its points gather until all are there.
std::string shards_of(const std::string& out);

/// What the folders hold of a sweep. Damaged or foreign files are left out, with a warning.
SweepResults gather(const SweepPlan& plan, const std::vector<std::string>& folders,
                    std::ostream& warnings);
/// Removes from the folder what these results were read from.
void remove_points(const SweepPlan& plan, const SweepResults& results, const ShardFolder& folder);

/// Writes the result of what is finished to plan.settings.out and returns the exit status. wall_s:
/// what the call took that ended the sweep.
int write_result(const SweepPlan& plan, const SweepResults& results, double wall_s);

/// Ends a sweep after its pool: writes the result and removes what it was made of, or says how to
/// go on. Returns the exit status.
int end_sweep(const SweepPlan& plan, ShardFolder& folder, const PoolEnd& end);

}  // namespace flatspeckle::apps
