#include "apps/sweep/curve_sweep.h"

#include <filesystem>
#include <iostream>

#include "apps/sweep/sweep_end.h"
#include "apps/sweep/sweep_plan.h"
#include "apps/sweep/sweep_ranks.h"
#include "apps/sweep/sweep_work.h"
#include "core/error.h"
#include "core/run/ranks.h"
#include "core/run/remote_batches.h"
#include "core/session/output_lock.h"
#include "core/session/shard_folder.h"

namespace flatspeckle::apps {

namespace {

using Part = ShardFolder::Part;

/// Whether the folder holds anything of this sweep.
bool has_begun(const SweepPlan& plan, ShardFolder& folder) {
  for (std::size_t run = 0; run < plan.runs(); ++run)
    for (Part part : {Part::finished, Part::unfinished})
      if (folder.has(plan.name(run), part) &&
          !folder.read(plan.name(run), part, plan.identity(run), [](const ResultReader&) {}))
        return true;
  return false;
}

/// Whether the result is there. Throws InputError where another run's is, unless this sweep was
/// begun to replace it.
bool is_complete(const SweepPlan& plan, ShardFolder& folder) {
  const std::string& out = plan.settings.out;
  if (!plan.settings.resume || !std::filesystem::exists(out)) return false;
  const ResultReader file(out);
  if (file.has_attribute("/", "identity") &&
      file.attribute<std::string>("/", "identity") == plan.identity())
    return file.attribute<bool>("/", "complete");
  if (!has_begun(plan, folder))
    throw InputError("resume: " + out + " holds another run; name another result file");
  return false;
}

ScatteredRuns share_of_runs(const SweepPlan& plan) {
  return ScatteredRuns(plan.runs(), plan.share.value_or(SweepShare{}));
}

/// Throws InputError where the points that are there are all of another sweep: rather a slip in the
/// keys than strays.
void refuse_foreign_folder(const SweepPlan& plan, ShardFolder& folder, const ScatteredRuns& runs) {
  constexpr int few = 2, enough = 16;
  int seen = 0;
  std::string wrong;
  for (std::size_t i = 0; i < runs.size() && seen < enough; ++i) {
    const std::string name = plan.name(runs[i]);
    if (!folder.has(name, Part::finished)) continue;
    const auto complaint =
        folder.read(name, Part::finished, plan.identity(runs[i]), [](const ResultReader&) {});
    if (!complaint || !complaint->starts_with("belongs")) return;
    wrong = *complaint;
    ++seen;
  }
  if (seen > few)
    throw InputError("resume: what " + folder.path().string() + " holds " + wrong +
                     "; name another result file, or remove the folder");
}

/// Throws InputError where work of an earlier sweep would be overwritten.
void refuse_leftovers(const SweepPlan& plan, const ShardFolder& folder, const ScatteredRuns& runs) {
  if (plan.settings.resume) return;
  for (std::size_t i = 0; i < runs.size(); ++i)
    if (const std::string name = plan.name(runs[i]);
        folder.has(name, Part::finished) || folder.has(name, Part::unfinished))
      throw InputError(folder.path().string() +
                       " holds points of an earlier sweep: --resume goes on with them; remove the "
                       "folder to begin again");
}

/// Of this process alone, or of rank 0.
int lead(const SweepPlan& plan, RankServer* server) {
  const std::string& out = plan.settings.out;
  const OutputLock lock(plan.share ? out + ".shard-" + std::to_string(plan.share->number) : out);
  ShardFolder folder(shards_of(out));
  if (is_complete(plan, folder)) {
    std::cout << out << " is complete; nothing to resume\n";
    remove_points(plan, gather(plan, {shards_of(out)}, std::cerr), folder);
    return ExitStatus::done;
  }
  const auto runs = share_of_runs(plan);
  refuse_leftovers(plan, folder, runs);
  refuse_foreign_folder(plan, folder, runs);
  folder.make();
  SweepWork work(plan, folder, runs);
  const PoolEnd end = run_pool(
      work.list(), {plan.settings.seconds, plan.session().threads(), "sweep", "points", server});
  work.save_unfinished();
  return end_sweep(plan, folder, end);
}

/// With rank 0, and for it.
void follow(const SweepPlan& plan) {
  ShardFolder none("");
  SweepWork work(plan, none, share_of_runs(plan));
  work_for_rank_0(work.list(), plan.session().threads());
}

class CurveSweep : public Call {
 public:
  Subcommand& command() override { return plan_.command(); }
  int run() override {
    if (!plan_.read()) return ExitStatus::done;
    if (!plan_.share) join_ranks();
    return on_all_ranks([&](RankServer* server) { return lead(plan_, server); },
                        [&] { follow(plan_); });
  }

 private:
  SweepPlan plan_;
};

}  // namespace

std::unique_ptr<Call> curve_sweep() {
  return std::make_unique<CurveSweep>();
}

}  // namespace flatspeckle::apps
