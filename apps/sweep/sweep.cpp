#include "apps/sweep/sweep.h"

#include <algorithm>
#include <charconv>
#include <iostream>
#include <map>
#include <memory>
#include <mutex>
#include <numeric>
#include <set>
#include <string>

#include "apps/sweep/point_store.h"
#include "core/error.h"
#include "core/keys/number_text.h"
#include "core/result/provenance.h"
#include "core/run/batch_pool.h"
#include "core/run/interrupt.h"
#include "core/run/ranks.h"
#include "core/run/runner.h"
#include "core/run/stopwatch.h"

namespace flatspeckle::apps {

namespace {

/// The runs of a sweep as a RunList for a pool. Each run continues from its saved state, if any;
/// its result is added to the PointStore. Runs that are already finished are skipped.
class SweepWork {
 public:
  /// Takes the runs of the shard that sweep.share() gives. store: nullptr for MPI processes that
  /// only compute batches.
  SweepWork(const Sweep& sweep, PointStore* store)
      : sweep_(sweep), store_(store), runs_(sweep.runs(), sweep.share().value_or(SweepShare{})) {}

  RunList list() {
    return {.count = runs_.size(),
            .open = [this](std::size_t number) { return open(runs_[number]); },
            .ended = [this](std::size_t number, StopReason) { ended(runs_[number]); },
            .checkpoint = [this](std::size_t number) { save(runs_[number]); },
            .job =
                [this](std::size_t number) {
                  // the job owns the run, to which its functions may refer
                  const auto run = std::make_shared<const SweepRun>(sweep_.open(runs_[number]));
                  BatchJob job = run->batches;
                  job.run = [run](std::uint64_t batch, std::span<Complex> sums) {
                    run->batches.run(batch, sums);
                  };
                  return job;
                }};
  }

  /// Saves the unfinished runs after the pool has stopped.
  void save_unfinished() {
    for (const auto& [number, open] : open_) save(number);
  }

 private:
  struct Open {
    SweepRun run;
    RunState state;
    std::string started;
  };

  std::optional<OpenRun> open(std::size_t number) {
    if (store_->has(number)) return std::nullopt;
    const std::string started = utc_now();
    auto open = std::make_unique<Open>(Open{sweep_.open(number), {}, started});
    open->state = store_->unfinished(number, open->run.batches.size);
    OpenRun run{open->run.batches, open->run.stop, &open->state};
    const std::lock_guard lock(mutex_);
    open_[number] = std::move(open);
    return run;
  }

  void ended(std::size_t number) {
    // stored for an unknown error, because result files cannot contain infinity
    constexpr double unknown = 1e300;
    const auto& [run, state, started] = find(number);
    FinishedPoint point{.plan = run.plan,
                        .started = started,
                        .samples = state.sums.total_samples(),
                        .cpu_s = state.cpu_s,
                        .wall_s = state.wall_s,
                        .relative_error = std::min(state.trace.relative_error.back(), unknown),
                        .result = {}};
    point.reached = (!run.stop.target_error || point.relative_error <= *run.stop.target_error) &&
                    !found_nothing(run.batches, state.sums);
    ResultFile collecting(point.result);
    run.write(collecting, state);
    point.reached =
        point.reached && point.result.keeps_invariants() && collecting.undefined().empty();
    store_->add(number, point);
    const std::lock_guard lock(mutex_);
    open_.erase(number);
  }

  void save(std::size_t number) {
    const RunState& state = find(number).state;
    if (state.sums.batches() > 0) store_->save_unfinished(number, state);
  }

  Open& find(std::size_t number) {
    const std::lock_guard lock(mutex_);
    return *open_.at(number);
  }

  const Sweep& sweep_;
  PointStore* store_;
  ScatteredRuns runs_;
  std::mutex mutex_;
  std::map<std::size_t, std::unique_ptr<Open>> open_;
};

namespace fs = std::filesystem;

bool is_whole(const Sweep& sweep, const PointStore& store) {
  return store.finished() == sweep.runs();
}

std::string count_text(const Sweep& sweep, const PointStore& store) {
  return std::to_string(sweep.finished_points(store)) + " of " +
         std::to_string(sweep.points().count()) + " points";
}

/// Returns the provenance of the result of a sweep. Its member `converged` is true if all finished
/// runs have converged.
Provenance made_of(const Sweep& sweep, const PointStore& store, double wall_s) {
  Provenance made = sweep.session().provenance();
  made.identity = sweep.identity();
  made.wall_s = wall_s;
  made.converged = true;
  std::set<std::string> plans;  // the different plans of the runs, at most 16 of them
  bool more = false;
  store.for_each([&](std::size_t, const FinishedPoint& point) {
    made.converged = made.converged && point.reached;
    made.started = std::min(made.started, point.started);
    made.cpu_s += point.cpu_s;
    made.samples += point.samples;
    plans.insert(point.plan);
    if (plans.size() <= 16) return;
    plans.erase(std::prev(plans.end()));
    more = true;
  });
  made.plan = join_texts({plans.begin(), plans.end()}, "\n") + (more ? "\nand others" : "");
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
  if (!all_reached)
    std::cout << "some points have not reached their target error or violate invariants\n";
  return made.converged ? ExitStatus::done : ExitStatus::error_not_reached;
}

/// Ends a sweep: writes the result of the finished points, unless this is one shard or the sweep
/// was interrupted. Removes the stored points if all are finished; otherwise prints how to
/// continue. Returns the exit status.
int end_sweep(const Sweep& sweep, PointStore& store, const PoolEnd& end) {
  const std::string place = shards_of(sweep.settings().out);
  const bool whole = is_whole(sweep, store);
  const bool interrupted = end.reason == StopReason::interrupted;
  if (interrupted) store.require_in_place();
  if (sweep.share() || interrupted) {
    std::cout << (interrupted ? "interrupted; " : "") << place << " contains "
              << count_text(sweep, store)
              << (whole                               ? "; `flatspeckle merge` makes the result\n"
                  : end.reason == StopReason::samples ? "; this shard is finished\n"
                                                      : "; continue with --resume\n");
    if (interrupted) return ExitStatus::interrupted_resumable;
    return end.reason == StopReason::samples ? ExitStatus::done : ExitStatus::error_not_reached;
  }
  int status = ExitStatus::error_not_reached;
  if (sweep.finished_points(store) > 0) status = write_result(sweep, store, end.wall_s);
  if (whole)
    store.remove();
  else
    std::cout << place << " contains " << count_text(sweep, store) << "; continue with --resume\n";
  return status;
}

/// Runs the sweep in a single process, or as rank 0 of several MPI processes. Returns the exit
/// status.
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
  try {
    const PoolEnd end = run_pool(work.list(), {sweep.settings().seconds, sweep.session().threads(),
                                               "sweep", "points", server});
    work.save_unfinished();
    store.sync();
    return end_sweep(sweep, store, end);
  } catch (const InputError&) {  // thrown for an invalid point
    if (store.finished() == 0) store.remove();
    throw;
  }
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

/// Computes batches that rank 0 sends, as one of several MPI processes.
void follow(const Sweep& sweep) {
  SweepWork work(sweep, nullptr);
  work_for_rank_0(work.list(), sweep.session().threads());
}

/// A sweep and the points of it that are stored in the folders.
struct Found {
  std::unique_ptr<Sweep> sweep;
  std::unique_ptr<PointStore> store;
};

/// Returns the different scene files (as texts) of the sweeps whose points are stored in these
/// folders.
std::set<std::string> configs_in(const std::vector<std::string>& folders) {
  std::set<std::string> configs;
  for (const std::string& folder : folders) {
    if (std::error_code none; !fs::is_directory(folder, none))
      throw InputError("shards", folder, "is not a folder");
    for (const fs::path& path : journals_in(folder))
      for (const std::string& config : Journal::configs_in(path)) configs.insert(config);
  }
  if (configs.empty())
    throw InputError("shards", folders.front(), "must contain finished points of a sweep");
  return configs;
}

void require_all(const Sweep& sweep, const PointStore& store) {
  if (is_whole(sweep, store)) return;
  std::size_t first = 0;
  while (store.has(first)) ++first;
  throw InputError(std::to_string(sweep.runs() - store.finished()) + " of " +
                   std::to_string(sweep.runs()) + " points are missing, such as " +
                   sweep.name(first) + "; --partial accepts missing points");
}

}  // namespace

std::string shards_of(const std::string& out) {
  return out + ".shards";
}

int Sweep::run() {
  if (!read()) return ExitStatus::done;
  if (!share_) initialize_ranks();
  catch_interrupts();
  if (ranks().size == 1) return lead(*this, nullptr);
  int status = ExitStatus::done;
  if (ranks().rank == 0)
    status = lead_others(*this);
  else
    follow(*this);
  leave_ranks();
  return status;
}

int merge_sweep(const std::function<std::unique_ptr<Sweep>(const std::string& config)>& make,
                const std::vector<std::string>& folders, const std::string& out, bool partial,
                const std::string& command_line) {
  const Stopwatch clock;
  // If the folders contain several scene files, for example because a grid was extended, the one
  // with the most finished points is used.
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
    throw InputError("shards", folders.front(), "must contain finished points of a sweep");
  if (!partial) require_all(*most.sweep, *most.store);
  if (most.sweep->finished_points(*most.store) == 0)
    throw InputError("shards", folders.front(),
                     "must have a point finished by every method: resume the sweep");
  return write_result(*most.sweep, *most.store, clock.seconds());
}

PointFinder::PointFinder(const SweepPoints& points) : points_(points) {
  if (points.is_list) {
    for (std::size_t row = 0; row < points.count(); ++row) rows_.emplace(points.name(row), row);
    return;
  }
  for (const SweepAxis& axis : points.axes) {
    Numbers& numbers = values_.emplace_back();
    if (axis.values.range() != nullptr) continue;
    for (std::size_t i = 0; i < axis.values.size(); ++i) numbers.emplace(axis.values[i], i);
  }
}

std::optional<std::size_t> PointFinder::find(const std::string& name) const {
  if (!points_.is_list) return on_grid(name);
  const auto found = rows_.find(name);
  return found == rows_.end() ? std::nullopt : std::optional(found->second);
}

/// Returns the index of the point with this name on a grid. In the name, the value of each axis is
/// followed by the name of the next axis.
std::optional<std::size_t> PointFinder::on_grid(const std::string& name) const {
  std::size_t point = 0, begin = 0;
  for (std::size_t i = 0; i < points_.axes.size(); ++i) {
    begin += points_.axes[i].key.size() + 1;
    const bool is_last = i + 1 == points_.axes.size();
    const std::size_t end =
        is_last ? name.size() : name.find('_' + points_.axes[i + 1].key + '=', begin);
    if (begin > name.size() || end == name.npos) return std::nullopt;
    const auto number = on_axis(i, name.substr(begin, end - begin));
    if (!number) return std::nullopt;
    point = point * points_.axes[i].values.size() + *number;
    begin = end + 1;
  }
  return points_.name(point) == name ? std::optional(point) : std::nullopt;
}

std::optional<std::size_t> PointFinder::on_axis(std::size_t axis, const std::string& value) const {
  if (const NumberRange* const range = points_.axes[axis].values.range()) {
    const auto number = read_number(value);
    return number ? range->find(*number) : std::nullopt;
  }
  const auto found = values_[axis].find(value);
  return found == values_[axis].end() ? std::nullopt : std::optional(found->second);
}

SweepShare share_of(const std::string& text) {
  SweepShare share;
  const char* const end = text.data() + text.size();
  const auto number = std::from_chars(text.data(), end, share.number);
  const bool slash = number.ec == std::errc{} && number.ptr != end && *number.ptr == '/';
  const auto count = slash ? std::from_chars(number.ptr + 1, end, share.count) : number;
  if (!slash || count.ec != std::errc{} || count.ptr != end || share.number >= share.count)
    throw InputError("shard", text, "must be i/n with 0 <= i < n");
  return share;
}

ScatteredRuns::ScatteredRuns(std::size_t runs, const SweepShare& share)
    : runs_(runs), stride_(std::max<std::size_t>(1, runs * 618 / 1000)), share_(share) {
  while (std::gcd(stride_, runs_) != 1) ++stride_;
}

std::size_t ScatteredRuns::size() const {
  return (runs_ + share_.count - 1 - share_.number) / share_.count;
}

std::size_t ScatteredRuns::operator[](std::size_t number) const {
  return (share_.number + number * share_.count) * stride_ % runs_;
}

/// Reads the keys of the sweep. Returns false if nothing is to be run (--print-config).
bool Sweep::read() {
  session_.emplace(command_.text(), keys(), run_, command_.only_prints(), Session::Out::shared);
  take_points();
  return command_.settle();
}

void Sweep::parse_config(const std::string& config, const std::string& command_line) {
  command_.parse_config(config);
  session_.emplace(command_line, keys(), run_, true);
  take_points();
}

void Sweep::take_points() {
  if (!keys().read(share_text_).empty()) share_ = share_of(share_text_);
  check();
}

void Sweep::add_share_key() {
  keys()
      .add("shard", share_text_,
           "i/n, with i from 0 to n - 1: compute only every nth point, starting with point i; "
           "`flatspeckle merge` combines the shards")
      .no_file();
}

std::size_t Sweep::finished_points(const PointStore& store) const {
  return store.finished();
}

}  // namespace flatspeckle::apps
