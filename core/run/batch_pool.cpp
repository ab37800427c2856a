#include "core/run/batch_pool.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <iostream>
#include <string>
#include <thread>
#include <utility>

#include "core/byte_stream.h"
#include "core/run/interrupt.h"
#include "core/run/ranks.h"
#include "core/run/stopwatch.h"

namespace flatspeckle {

namespace {

/// Message from another rank to rank 0. A rank first sends one greeting with its number of threads.
/// Then each of its threads repeatedly requests a batch; each request except the first contains the
/// result of the previous batch.
struct Request {
  enum Kind : std::uint32_t { greeting, first, delivery, interrupted } kind = first;
  std::uint32_t threads = 0;
  std::uint64_t run = 0, number = 0;
  double cpu_s = 0;
  // a delivery also contains the sums of the batch, after these members
};

struct Reply {
  BatchPool::Offer offer = BatchPool::Offer::none;
  std::uint64_t run = 0, number = 0;
};

Bytes message_of(const Request& request, const std::vector<Complex>& sums = {}) {
  ByteWriter message;
  message.put(request);
  message.put(sums);
  return message.take();
}

Reply reply_to(const Request& request, const std::vector<Complex>& sums = {}) {
  return ByteReader(query_rank_0(message_of(request, sums))).get<Reply>();
}

/// Cache of the jobs of the runs on which this rank works. A job is created when it is first
/// needed; the oldest ones are discarded.
class Jobs {
 public:
  explicit Jobs(const RunList& runs) : runs_(runs) {}

  std::shared_ptr<const BatchJob> get(std::size_t run) {
    const std::lock_guard lock(mutex_);
    auto& job = jobs_[run];
    if (!job) {
      constexpr std::size_t most = 16;
      job = std::make_shared<const BatchJob>(runs_.job(run));
      order_.push_back(run);
      if (order_.size() > most) {
        jobs_.erase(order_.front());
        order_.erase(order_.begin());
      }
    }
    return jobs_.at(run);
  }

 private:
  const RunList& runs_;
  std::mutex mutex_;
  std::map<std::size_t, std::shared_ptr<const BatchJob>> jobs_;
  std::vector<std::size_t> order_;
};

/// Requests, computes and delivers batches in one thread of a rank other than 0, until the pool has
/// ended.
void work_remotely(Jobs& jobs) {
  using Offer = BatchPool::Offer;
  double cpu_before = thread_cpu_seconds();
  auto reply = reply_to({});
  while (reply.offer != Offer::none) {
    if (reply.offer == Offer::later) {
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
      reply = reply_to({});
      continue;
    }
    std::vector<Complex> sums;
    try {
      const auto job = jobs.get(reply.run);
      sums.resize(job->size);
      job->run(reply.number, sums);
    } catch (const Interrupted&) {
      reply = reply_to({Request::interrupted});
      continue;
    }
    const double cpu_now = thread_cpu_seconds();
    const Request done{Request::delivery, 0, reply.run, reply.number, cpu_now - cpu_before};
    cpu_before = cpu_now;
    reply = reply_to(done, sums);
  }
}

}  // namespace

void RankServer::serve(BatchPool* pool) {
  if (silent_ranks_ < 0) silent_ranks_ = ranks().size - 1;
  while (silent_ranks_ > 0 || threads_ > 0) {
    if (const auto message = next_message())
      take_in(pool, message->from, message->bytes);
    else
      std::this_thread::sleep_for(std::chrono::microseconds(50));
  }
}

void RankServer::take_in(BatchPool* pool, int rank, const Bytes& message) {
  ByteReader bytes(message);
  const auto request = bytes.get<Request>();
  Reply reply;
  if (request.kind == Request::greeting) {
    --silent_ranks_;
    threads_ += static_cast<int>(request.threads);
  } else if (pool != nullptr) {
    try {
      if (request.kind == Request::interrupted)
        pool->interrupt();
      else if (request.kind == Request::delivery)
        pool->deliver({request.run, request.number, nullptr}, bytes.get<std::vector<Complex>>(),
                      request.cpu_s);
    } catch (...) {
      pool->fail(std::current_exception());
    }
    BatchPool::Batch batch;
    reply.offer = pool->offer(rank, batch);
    reply.run = batch.run;
    reply.number = batch.number;
  }
  if (request.kind != Request::greeting && reply.offer == BatchPool::Offer::none) --threads_;
  answer(rank, std::as_bytes(std::span(&reply, 1)));
}

void work_for_rank_0(const RunList& runs, int threads) {
  Jobs jobs(runs);
  query_rank_0(message_of({Request::greeting, static_cast<std::uint32_t>(threads)}));
#pragma omp parallel num_threads(threads)
  try {
    work_remotely(jobs);
  } catch (const std::exception& error) {
    std::cerr << "flatspeckle: process " << ranks().rank << ": " << error.what() << '\n';
    abort_ranks(1);
  }
}

BatchPool::BatchPool(const RunList& runs, const PoolOptions& options, int workers)
    : list_(runs),
      options_(options),
      lookahead_(16 * static_cast<std::uint64_t>(workers)),
      other_ranks_(options.server == nullptr ? 0 : static_cast<std::size_t>(ranks().size - 1)),
      progress_(options.label, options.unit) {}

void BatchPool::check_for_end() {
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

/// Returns a run whose next batch is certainly needed, whatever its error turns out to be;
/// runs_.end() if there is none. Prefers runs on which this rank has worked (Use::own) to runs on
/// which no rank has worked (nobodys) and to others, because creating a job takes time. worst:
/// least preferred Use that is accepted.
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

/// Returns the run that probably needs the most work; runs_.end() if there is none. Its next batch
/// may turn out to be unnecessary.
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

/// Whether another run should be opened now, so that for each other rank a run is open on which no
/// rank works yet.
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
    check_for_end();
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
  check_for_end();
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
  if (found == runs_.end()) return;  // the run has ended and does not need this batch
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
  ended_cpu_s_ += run.cpu_s;
  const StopReason reason = *run.merger->ended();
  lock.unlock();
  if (list_.ended) list_.ended(number, reason);
  lock.lock();
  ++ended_;  // not executed if RunList::ended() has thrown Interrupted after a signal
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
  figures.cpu_s = cpu_s_;
  figures.seconds_left = seconds_left();
  return figures;
}

/// Returns the expected time, in seconds, until all runs have ended. Runs that have not begun are
/// assumed to need the mean time of the other runs.
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
