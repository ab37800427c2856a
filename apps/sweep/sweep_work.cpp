#include "apps/sweep/sweep_work.h"

#include "core/result/provenance.h"

namespace flatspeckle::apps {

SweepWork::SweepWork(const Sweep& sweep, PointStore* store)
    : sweep_(sweep), store_(store), runs_(sweep.runs(), sweep.share().value_or(SweepShare{})) {}

RunList SweepWork::list() {
  return {.count = runs_.size(),
          .open = [this](std::size_t number) { return open(runs_[number]); },
          .ended = [this](std::size_t number, StopReason) { ended(runs_[number]); },
          .checkpoint = [this](std::size_t number) { save(runs_[number]); },
          .job =
              [this](std::size_t number) {
                // what is planned may look at what it is planned of
                const auto run = std::make_shared<const SweepRun>(sweep_.open(runs_[number]));
                BatchJob job = run->batches;
                job.run = [run](std::uint64_t batch, std::span<Complex> sums) {
                  run->batches.run(batch, sums);
                };
                return job;
              }};
}

std::optional<OpenRun> SweepWork::open(std::size_t number) {
  if (store_->has(number)) return std::nullopt;
  const std::string started = utc_now();
  auto open = std::make_unique<Open>(Open{sweep_.open(number), {}, started});
  open->state = store_->unfinished(number, open->run.batches.size);
  OpenRun run{open->run.batches, open->run.stop, &open->state};
  const std::lock_guard lock(mutex_);
  open_[number] = std::move(open);
  return run;
}

SweepWork::Open& SweepWork::find(std::size_t number) {
  const std::lock_guard lock(mutex_);
  return *open_.at(number);
}

void SweepWork::ended(std::size_t number) {
  const auto& [run, state, started] = find(number);
  FinishedPoint point{.plan = run.plan,
                      .started = started,
                      .samples = state.sums.total_samples(),
                      .cpu_s = state.cpu_s,
                      .wall_s = state.wall_s,
                      .relative_error = state.trace.relative_error.back(),
                      .result = {}};
  point.reached = !run.stop.target_error || point.relative_error <= *run.stop.target_error;
  ResultFile collecting(point.result);
  run.write(collecting, state);
  store_->add(number, point);
  const std::lock_guard lock(mutex_);
  open_.erase(number);
}

void SweepWork::save(std::size_t number) {
  const RunState& state = find(number).state;
  if (state.sums.batches() > 0) store_->save_unfinished(number, state);
}

void SweepWork::save_unfinished() {
  for (const auto& [number, open] : open_) save(number);
}

}  // namespace flatspeckle::apps
