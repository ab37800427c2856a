#include "apps/sweep/run_sweep.h"

#include <algorithm>
#include <iostream>
#include <set>

#include "apps/sweep/sweep_work.h"
#include "core/error.h"
#include "core/keys/number_text.h"
#include "core/run/interrupt.h"
#include "core/run/ranks.h"
#include "core/run/remote_batches.h"
#include "core/run/stopwatch.h"

namespace flatspeckle::apps {

namespace {

namespace fs = std::filesystem;

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

bool is_whole(const Sweep& sweep, const PointStore& store) {
  return store.finished() == sweep.runs();
}

std::string count_text(const Sweep& sweep, const PointStore& store) {
  return std::to_string(sweep.finished_points(store)) + " of " +
         std::to_string(sweep.points().count()) + " points";
}

/// How the whole was made. Converged: all runs that are there.
Provenance made_of(const Sweep& sweep, const PointStore& store, double wall_s) {
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

int write_result(const Sweep& sweep, const PointStore& store, double wall_s) {
  Provenance made = made_of(sweep, store, wall_s);
  const bool all_reached = made.converged;
  made.converged = all_reached && is_whole(sweep, store);
  ResultFile file(sweep.settings().out, ResultFile::Storage::disk);
  file.attribute("/", "complete", is_whole(sweep, store));
  file.attribute("/", "ranks", std::int64_t{ranks().size});
  sweep.write(file, store);
  std::cout << count_text(sweep, store) << '\n';
  Session::commit(file, made);
  if (!all_reached) std::cout << "not every point has reached its target error\n";
  return made.converged ? ExitStatus::done : ExitStatus::error_not_reached;
}

/// Writes the result and removes what it was made of, or says how to go on.
int end_sweep(const Sweep& sweep, PointStore& store, const PoolEnd& end) {
  const std::string place = shards_of(sweep.settings().out);
  const bool whole = is_whole(sweep, store);
  const bool interrupted = end.reason == StopReason::interrupted;
  if (sweep.share() || interrupted) {
    std::cout << (interrupted ? "interrupted; " : "") << place << " holds "
              << count_text(sweep, store)
              << (whole                               ? "; `flatspeckle merge` makes the result\n"
                  : end.reason == StopReason::samples ? "; this share is done\n"
                                                      : "; --resume goes on\n");
    if (interrupted) return ExitStatus::interrupted_resumable;
    return end.reason == StopReason::samples ? ExitStatus::done : ExitStatus::error_not_reached;
  }
  int status = ExitStatus::error_not_reached;
  if (sweep.finished_points(store) > 0) status = write_result(sweep, store, end.wall_s);
  if (whole)
    store.remove();
  else
    std::cout << place << " holds " << count_text(sweep, store) << "; --resume goes on\n";
  return status;
}

/// Of this process alone, or of rank 0.
int lead(const Sweep& sweep, RankServer* server) {
  const std::string& out = sweep.settings().out;
  const OutputLock lock(sweep.share() ? out + ".shard-" + std::to_string(sweep.share()->number)
                                      : out);
  const std::string folder = shards_of(out);
  if (sweep.session().is_complete(sweep.identity(), !journals_in(folder).empty())) {
    PointStore(sweep, std::vector{folder}).remove();
    return ExitStatus::done;
  }
  PointStore store(sweep, folder);
  SweepWork work(sweep, &store);
  const PoolEnd end = run_pool(work.list(), {sweep.settings().seconds, sweep.session().threads(),
                                             "sweep", "points", server});
  work.save_unfinished();
  store.sync();
  return end_sweep(sweep, store, end);
}

int lead_others(const Sweep& sweep) {
  RankServer server;
  try {
    const int status = lead(sweep, &server);
    server.dismiss();
    return status;
  } catch (...) {
    server.dismiss();
    leave_ranks();
    throw;
  }
}

/// With rank 0, and for it.
void follow(const Sweep& sweep) {
  SweepWork work(sweep, nullptr);
  work_for_rank_0(work.list(), sweep.session().threads());
}

/// A sweep and what folders hold of it.
struct Found {
  std::unique_ptr<Sweep> sweep;
  std::unique_ptr<PointStore> store;
};

/// Every configuration that points in the folders were made with.
std::set<std::string> configs_in(const std::vector<std::string>& folders) {
  std::set<std::string> configs;
  for (const std::string& folder : folders) {
    if (std::error_code none; !fs::is_directory(folder, none))
      throw InputError("shards", folder, "is not a folder");
    for (const fs::path& path : journals_in(folder))
      for (const std::string& config : Journal::configs_in(path)) configs.insert(config);
  }
  if (configs.empty())
    throw InputError("shards", folders.front(), "holds no finished points of a sweep");
  return configs;
}

void require_all(const Sweep& sweep, const PointStore& store) {
  if (is_whole(sweep, store)) return;
  std::size_t first = 0;
  while (store.has(first)) ++first;
  throw InputError(std::to_string(sweep.runs() - store.finished()) + " of " +
                   std::to_string(sweep.runs()) + " points are missing, " + sweep.name(first) +
                   " among them; --partial takes what there is");
}

}  // namespace

std::string shards_of(const std::string& out) {
  return out + ".shards";
}

int run_sweep(const Sweep& sweep) {
  if (!sweep.share()) join_ranks();
  catch_interrupts();
  if (ranks().size == 1) return lead(sweep, nullptr);
  int status = ExitStatus::done;
  if (ranks().rank == 0)
    status = lead_others(sweep);
  else
    follow(sweep);
  leave_ranks();
  return status;
}

int merge_sweep(const std::function<std::unique_ptr<Sweep>(const std::string& config)>& make,
                const std::vector<std::string>& folders, const std::string& out, bool partial,
                const std::string& command_line) {
  const Stopwatch clock;
  // of several the one that most points are of: a smaller grid may have grown
  Found most;
  for (const std::string& config : configs_in(folders)) {
    Found found{make(config), nullptr};
    found.sweep->parse_config(config, command_line);
    found.sweep->set_out(out);
    found.store = std::make_unique<PointStore>(*found.sweep, folders);
    if (!most.store || found.store->finished() > most.store->finished()) most = std::move(found);
  }
  std::cerr << most.store->warnings();
  if (most.store->finished() == 0)
    throw InputError("shards", folders.front(), "holds no finished points of a sweep");
  if (!partial) require_all(*most.sweep, *most.store);
  if (most.sweep->finished_points(*most.store) == 0)
    throw InputError("shards", folders.front(), "no point is finished by every method");
  return write_result(*most.sweep, *most.store, clock.seconds());
}

}  // namespace flatspeckle::apps
