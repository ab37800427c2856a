#include "apps/experiments/sweep_experiments.h"

#include <algorithm>
#include <iostream>
#include <set>

#include "apps/experiments/experiment_work.h"
#include "apps/experiments/stacked_result.h"
#include "apps/results/datasets.h"
#include "apps/sweep/sweep_end.h"
#include "apps/sweep/sweep_ranks.h"
#include "core/error.h"
#include "core/keys/number_text.h"
#include "core/result/result_group.h"
#include "core/run/interrupt.h"
#include "core/run/ranks.h"
#include "core/run/remote_batches.h"
#include "core/run/stopwatch.h"

namespace flatspeckle::apps {

namespace {

namespace fs = std::filesystem;

std::string count_text(const ExperimentSweep& sweep, const PointStore& store) {
  return std::to_string(store.finished()) + " of " + std::to_string(sweep.points().count()) +
         " points";
}

/// Each plan once, if there are not too many.
class Plans {
 public:
  void add(const std::string& plan) {
    plans_.insert(plan);
    constexpr std::size_t most = 16;
    has_more_ = has_more_ || plans_.size() > most;
    if (plans_.size() > most) plans_.erase(std::prev(plans_.end()));
  }
  std::string text() const {
    return joined({plans_.begin(), plans_.end()}, "\n") + (has_more_ ? "\nand others" : "");
  }

 private:
  std::set<std::string> plans_;
  bool has_more_ = false;
};

/// Converged: all points that are there.
Provenance made_of(const ExperimentSweep& sweep, const PointStore& store, double wall_s) {
  Provenance made = sweep.session().provenance();
  made.identity = sweep.identity();
  made.wall_s = wall_s;
  made.converged = true;
  Plans plans;
  store.for_each([&](std::size_t, const FinishedPoint& point) {
    made.converged = made.converged && point.reached;
    made.started = std::min(made.started, point.started);
    made.cpu_s += point.cpu_s;
    made.samples += point.samples;
    plans.add(point.plan);
  });
  made.plan = plans.text();
  return made;
}

int write_result(const ExperimentSweep& sweep, const PointStore& store, double wall_s) {
  const bool is_whole = store.finished() == sweep.points().count();
  Provenance made = made_of(sweep, store, wall_s);
  const bool all_reached = made.converged;
  made.converged = all_reached && is_whole;
  ResultFile file(sweep.out(), ResultFile::Storage::disk);
  const ResultGroup root(file, stacked_table);
  root.attribute("of", sweep.of());
  root.attribute("complete", is_whole);
  root.attribute("ranks", std::int64_t{ranks().size});
  write_stacked(file, sweep, store);
  std::cout << count_text(sweep, store) << '\n';
  Session::commit(file, made);
  if (!all_reached) std::cout << "not every point has reached its target error\n";
  return made.converged ? ExitStatus::done : ExitStatus::error_not_reached;
}

int end_sweep(const ExperimentSweep& sweep, PointStore& store, const PoolEnd& end) {
  const std::string place = shards_of(sweep.out());
  const bool is_whole = store.finished() == sweep.points().count();
  const bool interrupted = end.reason == StopReason::interrupted;
  if (sweep.is_share() || interrupted) {
    std::cout << (interrupted ? "interrupted; " : "") << place << " holds "
              << count_text(sweep, store)
              << (is_whole                            ? "; `flatspeckle merge` makes the result\n"
                  : end.reason == StopReason::samples ? "; this share is done\n"
                                                      : "; --resume goes on\n");
    if (interrupted) return ExitStatus::interrupted_resumable;
    return end.reason == StopReason::samples ? ExitStatus::done : ExitStatus::error_not_reached;
  }
  int status = ExitStatus::error_not_reached;
  if (store.finished() > 0) status = write_result(sweep, store, end.wall_s);
  if (is_whole)
    store.remove();
  else
    std::cout << place << " holds " << count_text(sweep, store) << "; --resume goes on\n";
  return status;
}

/// Whether the result is there. Throws InputError where another run's is, unless this sweep was
/// begun to replace it.
bool is_complete(const ExperimentSweep& sweep) {
  const std::string& out = sweep.out();
  if (!sweep.settings().resume || !fs::exists(out)) return false;
  const ResultReader file(out);
  if (file.has_attribute("/", "identity") &&
      file.attribute<std::string>("/", "identity") == sweep.identity())
    return file.attribute<bool>("/", "complete");
  if (journals_in(shards_of(out)).empty())
    throw InputError("resume: " + out + " holds another run; name another result file");
  return false;
}

/// Of this process alone, or of rank 0.
int lead(const ExperimentSweep& sweep, RankServer* server) {
  const std::string& out = sweep.out();
  const OutputLock lock(sweep.is_share() ? out + ".shard-" + std::to_string(sweep.share().number)
                                         : out);
  if (is_complete(sweep)) {
    std::cout << out << " is complete; nothing to resume\n";
    PointStore(sweep, std::vector{shards_of(out)}).remove();
    return ExitStatus::done;
  }
  PointStore store(sweep, shards_of(out));
  ExperimentWork work(sweep, &store);
  const PoolEnd end = run_pool(work.list(), {sweep.settings().seconds, sweep.session().threads(),
                                             "sweep", "points", server});
  work.save_unfinished();
  store.sync();
  return end_sweep(sweep, store, end);
}

/// With rank 0, and for it.
void follow(const ExperimentSweep& sweep) {
  ExperimentWork work(sweep, nullptr);
  work_for_rank_0(work.list(), sweep.session().threads());
}

class SweepOf : public Call {
 public:
  explicit SweepOf(const std::string& of) : sweep_(of) {}

  Subcommand& command() override { return sweep_.command(); }
  int run() override {
    if (!sweep_.read()) return ExitStatus::done;
    if (!sweep_.is_share()) join_ranks();
    return on_all_ranks([&](RankServer* server) { return lead(sweep_, server); },
                        [&] { follow(sweep_); });
  }

 private:
  ExperimentSweep sweep_;
};

}  // namespace

std::unique_ptr<Call> sweep_of(const std::string& of) {
  return std::make_unique<SweepOf>(of);
}

int merge_experiments(const std::vector<std::string>& folders, const std::string& out, bool partial,
                      const std::string& command_line) {
  const Stopwatch clock;
  const SweepHead head = PointJournal::head_of(journals_in(folders.front()).front());
  ExperimentSweep sweep(value_in("of", head.config));
  sweep.parse_config(head.config, command_line);
  sweep.set_out(out);
  const PointStore store(sweep, folders);
  const std::size_t all = sweep.points().count(), missing = all - store.finished();
  if (missing == all || (!partial && missing > 0))
    throw InputError(std::to_string(missing) + " of " + std::to_string(all) +
                     " points are missing; --partial takes what there is");
  return write_result(sweep, store, clock.seconds());
}

}  // namespace flatspeckle::apps
