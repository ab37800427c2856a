#include "apps/experiments/experiment_work.h"

#include <utility>

#include "apps/experiments/at_point.h"
#include "core/result/provenance.h"

namespace flatspeckle::apps {

ExperimentWork::ExperimentWork(const ExperimentSweep& sweep, PointStore* store)
    : sweep_(sweep), store_(store), points_(sweep.points().count(), sweep.share()) {}

RunList ExperimentWork::list() {
  return {.count = points_.size(),
          .open = [this](std::size_t number) { return open(points_[number]); },
          .ended = [this](std::size_t number, StopReason) { ended(points_[number]); },
          .checkpoint = [this](std::size_t number) { save(points_[number]); },
          .job =
              [this](std::size_t number) {
                // what is planned may look at what it is planned of
                const std::shared_ptr<Experiment> experiment = sweep_.experiment(points_[number]);
                BatchJob job = plan_at(sweep_.points(), points_[number], *experiment).batches;
                job.run = [experiment, run = job.run](
                              std::uint64_t batch, std::span<Complex> sums) { run(batch, sums); };
                return job;
              }};
}

std::optional<OpenRun> ExperimentWork::open(std::size_t point) {
  if (store_->has(point)) return std::nullopt;
  auto open = std::make_unique<Open>();
  open->started = utc_now();
  open->experiment = sweep_.experiment(point);
  open->planned = plan_at(sweep_.points(), point, *open->experiment);
  open->state = store_->unfinished(point, open->planned.batches.size);
  OpenRun run{open->planned.batches, open->experiment->stop(), &open->state};
  const std::lock_guard lock(mutex_);
  open_[point] = std::move(open);
  return run;
}

ExperimentWork::Open& ExperimentWork::find(std::size_t point) {
  const std::lock_guard lock(mutex_);
  return *open_.at(point);
}

void ExperimentWork::ended(std::size_t number) {
  const Open& open = find(number);
  FinishedPoint point{.plan = open.planned.plan,
                      .started = open.started,
                      .samples = open.state.sums.total_samples(),
                      .cpu_s = open.state.cpu_s,
                      .wall_s = open.state.wall_s,
                      .relative_error = open.state.trace.relative_error.back(),
                      .result = {}};
  const auto target = open.experiment->stop().target_error;
  point.reached = !target || point.relative_error <= *target;
  ResultFile collecting(point.result);
  open.planned.write(collecting, open.state.sums);
  store_->add(number, point);
  const std::lock_guard lock(mutex_);
  open_.erase(number);
}

void ExperimentWork::save(std::size_t point) {
  const Open& open = find(point);
  if (open.state.sums.batches() == 0) return;
  Provenance made = sweep_.session().provenance();
  made.plan = open.planned.plan;
  made.wall_s = open.state.wall_s;
  made.cpu_s = open.state.cpu_s;
  made.samples = open.state.sums.total_samples();
  store_->save_unfinished(point, made, open.state);
}

void ExperimentWork::save_unfinished() {
  for (const auto& [point, open] : open_) save(point);
}

}  // namespace flatspeckle::apps
