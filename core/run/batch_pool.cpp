#include "core/run/batch_pool.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "core/run/interrupt.h"
#include "core/run/ranks.h"

namespace flatspeckle {

BatchPool::BatchPool(const RunList& runs, const PoolOptions& options, int workers)
    : list_(runs),
      options_(options),
      lookahead_(16 * static_cast<std::uint64_t>(workers)),
      other_ranks_(options.server == nullptr ? 0 : static_cast<std::size_t>(ranks().size - 1)),
      progress_(options.label, options.unit) {}

void BatchPool::look_for_end() {
  if (stopped_) return;
  if (interrupted())
    stopped_ = StopReason::interrupted;
  else if (options_.seconds && ended_ + runs_.size() > 0 && clock_.seconds() >= *options_.seconds)
    stopped_ = StopReason::seconds;
}

bool BatchPool::may_take(const Run& run) const {
  if (stopped_ && (*stopped_ == StopReason::interrupted || run.next >= fewest_batches))
    return false;
  const std::uint64_t ahead = run.job->one_by_one ? 1 : lookahead_;
  return run.next < run.limit && run.next < run.merged + ahead;
}

BatchPool::Use BatchPool::use_of(const Run& run, int rank) {
  if (run.ranks.contains(rank)) return Use::own;
  return run.ranks.empty() ? Use::nobodys : Use::others;
}

/// A batch that its run needs whatever the error turns out to be, best of a run that this rank has
/// worked on, since making its job takes time; at worst one that is used as `worst` says.
BatchPool::Runs::iterator BatchPool::with_certain_batch(int rank, Use worst) {
  auto found = runs_.end();
  for (auto run = runs_.begin(); run != runs_.end(); ++run) {
    if (run->second->next >= run->second->certain || !may_take(*run->second)) continue;
    const Use use = use_of(*run->second, rank);
    if (use > worst || (found != runs_.end() && use >= use_of(*found->second, rank))) continue;
    found = run;
    if (use == Use::own) break;
  }
  return found;
}

/// The run that is likely to need most: its batch may turn out not to be needed.
BatchPool::Runs::iterator BatchPool::with_any_batch() {
  auto found = runs_.end();
  for (auto run = runs_.begin(); run != runs_.end(); ++run) {
    if (!may_take(*run->second)) continue;
    if (found == runs_.end() || run->second->cpu_s_left > found->second->cpu_s_left) found = run;
  }
  return found;
}

BatchPool::Batch BatchPool::hand_out(Runs::iterator found, int rank) {
  auto& [number, run] = *found;
  run->ranks.insert(rank);
  return {number, run->next++, run->job};
}

/// Whether other ranks soon want a run that nobody works on.
bool BatchPool::should_open() const {
  const auto in_stock = std::count_if(
      runs_.begin(), runs_.end(), [](const auto& entry) { return entry.second->ranks.empty(); });
  return static_cast<std::size_t>(in_stock) + opening_ < other_ranks_;
}

bool BatchPool::is_over() const {
  return stopped_ || (next_run_ == list_.count && runs_.empty() && opening_ == 0);
}

std::optional<BatchPool::Batch> BatchPool::take() {
  constexpr int here = 0;
  std::unique_lock lock(mutex_);
  while (!error_) {
    look_for_end();
    const bool fresh = !stopped_ && next_run_ < list_.count;
    const auto certain = with_certain_batch(here, fresh ? Use::nobodys : Use::others);
    if (fresh && (certain == runs_.end() || should_open())) {
      open_next(lock);
      continue;
    }
    if (certain != runs_.end()) return hand_out(certain, here);
    if (const auto run = with_any_batch(); run != runs_.end()) return hand_out(run, here);
    if (is_over()) break;
    changed_.wait(lock);
  }
  return std::nullopt;
}

BatchPool::Offer BatchPool::offer(int rank, Batch& batch) {
  const std::lock_guard lock(mutex_);
  if (error_) return Offer::none;
  look_for_end();
  const bool fresh = !stopped_ && next_run_ < list_.count;
  auto run = with_certain_batch(rank, fresh ? Use::nobodys : Use::others);
  if (run == runs_.end() && !fresh) run = with_any_batch();
  if (run == runs_.end()) return is_over() ? Offer::none : Offer::later;
  batch = hand_out(run, rank);
  return Offer::batch;
}

void BatchPool::open_next(std::unique_lock<std::mutex>& lock) {
  const std::size_t number = next_run_++;
  ++opening_;
  lock.unlock();
  auto opened = list_.open(number);
  if (!opened) {
    lock.lock();
    --opening_;
    ++idle_;
    changed_.notify_all();
    return;
  }
  auto& [job, stop, state] = *opened;
  auto run = std::make_shared<Run>();
  run->job = std::make_shared<const BatchJob>(std::move(job));
  if (state->sums.size() != run->job->size) state->sums = GroupedSums(run->job->size);
  run->merger = std::make_unique<RunMerger>(*run->job, stop, *state);
  run->next = run->merged = state->sums.batches();
  run->limit = run->merger->limit();
  run->certain = run->merger->certain();
  lock.lock();
  --opening_;
  first_samples_ += state->sums.total_samples();
  if (run->merger->ended())
    end(number, *run, lock);
  else
    runs_.emplace(number, std::move(run));
  changed_.notify_all();
}

void BatchPool::deliver(const Batch& batch, std::vector<Complex> sums, double cpu_s) {
  std::unique_lock lock(mutex_);
  cpu_s_ += cpu_s;
  const auto found = runs_.find(batch.run);
  if (found == runs_.end()) return;  // ended without it
  const std::shared_ptr<Run> run = found->second;
  run->waiting.emplace(batch.number, Sums{std::move(sums), cpu_s});
  if (!run->merging) merge(batch.run, *run, lock);
  changed_.notify_all();
}

void BatchPool::merge(std::size_t number, Run& run, std::unique_lock<std::mutex>& lock) {
  run.merging = true;
  while (!run.waiting.empty() && run.waiting.begin()->first == run.merged) {
    const auto next = run.waiting.extract(run.waiting.begin());
    lock.unlock();
    run.merger->add(next.mapped().values, next.mapped().cpu_s);
    save_now_and_then(number, run);
    lock.lock();
    ++run.merged;
    run.cpu_s += next.mapped().cpu_s;
    run.certain = run.merger->certain();
    run.cpu_s_left = run.merger->cpu_s_left();
    new_samples_ += run.job->samples_per_batch;
    last_error_ = run.merger->error();
    if (run.merger->ended()) {
      runs_.erase(number);
      end(number, run, lock);
      return;
    }
    changed_.notify_all();
  }
  run.merging = false;
}

void BatchPool::save_now_and_then(std::size_t number, Run& run) const {
  if (!list_.checkpoint || run.merger->seconds_since_saved() < options_.seconds_between_saves)
    return;
  run.merger->note_saved();
  list_.checkpoint(number);
}

void BatchPool::end(std::size_t number, const Run& run, std::unique_lock<std::mutex>& lock) {
  ++ended_;
  ended_cpu_s_ += run.cpu_s;
  const StopReason reason = *run.merger->ended();
  lock.unlock();
  if (list_.ended) list_.ended(number, reason);
  lock.lock();
}

void BatchPool::show_progress() {
  const std::lock_guard lock(mutex_);
  if (const double wall = clock_.seconds(); progress_.due(wall)) progress_.update(wall, figures());
}

void BatchPool::interrupt() {
  const std::lock_guard lock(mutex_);
  stopped_ = StopReason::interrupted;
  changed_.notify_all();
}

void BatchPool::fail(std::exception_ptr error) {
  const std::lock_guard lock(mutex_);
  if (!error_) error_ = std::move(error);
  changed_.notify_all();
}

PoolEnd BatchPool::finish() {
  if (error_) std::rethrow_exception(error_);
  for (const auto& [number, run] : runs_) {
    run->merger->settle();
    last_error_ = run->merger->error();
  }
  progress_.finish(clock_.seconds(), figures());
  return {stopped_ && ended_ + idle_ < list_.count ? *stopped_ : StopReason::samples,
          clock_.seconds(), cpu_s_};
}

Progress::Figures BatchPool::figures() const {
  Progress::Figures figures;
  if (list_.count == 1)
    figures.error = last_error_;
  else
    figures.done =
        std::to_string(ended_) + " of " + std::to_string(list_.count) + ' ' + options_.run_name;
  figures.samples = first_samples_ + new_samples_;
  figures.rate = new_samples_ / clock_.seconds();
  figures.seconds_left = seconds_left();
  return figures;
}

/// Runs that have not begun are taken to cost as much as the others do on the mean.
double BatchPool::seconds_left() const {
  double left = 0, whole = ended_cpu_s_;
  for (const auto& [number, run] : runs_) {
    left += run->cpu_s_left;
    whole += run->cpu_s + run->cpu_s_left;
  }
  const double begun = static_cast<double>(ended_ + runs_.size());
  left += static_cast<double>(list_.count - next_run_) * whole / begun;
  const double seconds = left * clock_.seconds() / cpu_s_;
  if (!options_.seconds) return seconds;
  return std::clamp(*options_.seconds - clock_.seconds(), 0.0, std::max(seconds, 0.0));
}

}  // namespace flatspeckle
