#include "apps/sweep/sweep_work.h"

#include <utility>

#include "apps/sweep/point_result.h"
#include "core/result/provenance.h"
#include "core/result/run_state_file.h"

namespace flatspeckle::apps {

SweepWork::SweepWork(const SweepPlan& plan, ShardFolder& folder, const ScatteredRuns& runs)
    : plan_(plan), folder_(folder), runs_(runs) {}

RunList SweepWork::list() {
  return {.count = runs_.size(),
          .open = [this](std::size_t number) { return open(runs_[number]); },
          .ended = [this](std::size_t number, StopReason) { ended(runs_[number]); },
          .checkpoint = [this](std::size_t number) { save(runs_[number]); },
          .job =
              [this](std::size_t number) {
                const std::size_t run = runs_[number];
                return plan_.estimation(run, plan_.scene(run)).job.batches;
              }};
}

/// False where there is nothing, or nothing that can be used.
bool SweepWork::read_or_set_aside(std::size_t number, Part part,
                                  const std::function<void(const ResultReader&)>& reading) {
  const std::string name = plan_.name(number);
  if (!folder_.has(name, part)) return false;
  const auto wrong = folder_.read(name, part, plan_.identity(number), reading);
  if (wrong) folder_.set_aside(name, part, *wrong);
  return !wrong;
}

std::optional<OpenRun> SweepWork::open(std::size_t number) {
  if (read_or_set_aside(number, Part::finished, read_point)) return std::nullopt;
  Scene scene = plan_.scene(number);
  Estimation estimation = plan_.estimation(number, scene);
  const BatchJob job = estimation.job.batches;
  RunState state;
  read_or_set_aside(number, Part::unfinished,
                    [&](const ResultReader& file) { state = read_state(file, "state", job.size); });
  const std::lock_guard lock(mutex_);
  auto& kept = open_[number];
  kept = std::make_unique<Open>(Open{std::move(scene), std::move(estimation), std::move(state)});
  return OpenRun{job, plan_.stop(number), &kept->state};
}

SweepWork::Open& SweepWork::find(std::size_t number) {
  const std::lock_guard lock(mutex_);
  return *open_.at(number);
}

/// How it was made.
void SweepWork::write_made(ResultFile& file, const Open& open, bool converged) const {
  Provenance made = plan_.session().provenance();
  made.plan = open.estimation.plan;
  made.wall_s = open.state.wall_s;
  made.cpu_s = open.state.cpu_s;
  made.samples = open.state.sums.total_samples();
  made.converged = converged;
  write_provenance(file, made);
}

void SweepWork::ended(std::size_t number) {
  Open& open = find(number);
  PointResult point = point_result(open.scene, open.estimation.job, open.state);
  const auto target = plan_.stop(number).target_error;
  point.reached = !target || point.relative_error <= *target;
  // To wait for the disk at each of many quick points would take longer than they do.
  constexpr double quick = 1;
  const Durable durable = open.state.cpu_s > quick ? Durable::yes : Durable::no;
  folder_.write(plan_.name(number), Part::finished, plan_.identity(number), durable,
                [&](ResultFile& file) {
                  write_made(file, open, point.reached);
                  write_point(file, point, open.scene);
                });
  const std::lock_guard lock(mutex_);
  open_.erase(number);
}

void SweepWork::save(std::size_t number) {
  const Open& open = find(number);
  if (open.state.sums.batches() == 0) return;
  folder_.write(plan_.name(number), Part::unfinished, plan_.identity(number), Durable::yes,
                [&](ResultFile& file) {
                  write_made(file, open, false);
                  write_state(file, "state", open.state);
                });
}

void SweepWork::save_unfinished() {
  for (const auto& [number, open] : open_) save(number);
}

}  // namespace flatspeckle::apps
