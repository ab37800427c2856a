#include "apps/command/experiment.h"

#include "core/result/collected_result.h"
#include "core/run/interrupt.h"

namespace flatspeckle::apps {

int Experiment::run_alone(Session& session, const std::string& label) const {
  const PlannedExperiment planned = plan();
  return session.run(planned.plan, {{"", label, planned.batches, stop_}}, inputs_,
                     [&](ResultFile& file) { planned.write(file, session.sums(""), true); });
}

PlannedExperiment OneShot::plan() const {
  const auto made = std::make_shared<CollectedResult>();
  BatchJob job;
  job.size = 1;
  job.one_by_one = true;
  job.relative_error = [](const GroupedSums&) { return 0.0; };
  job.run = [this, made](std::uint64_t batch, std::span<Complex>) {
    if (batch > 0) return;
    ResultFile collecting(*made);
    if (!make(collecting, false)) throw Interrupted{};
  };
  return {.plan = "at once",
          .batches = job,
          .write = [made](ResultFile& file, const GroupedSums&, bool) { put(file, *made); }};
}

int OneShot::run_alone(Session& session, const std::string&) const {
  if (looks_for_signals()) catch_interrupts();
  return session.once(ResultFile(session.out(), storage()),
                      [&](ResultFile& file) { return make(file, true); });
}

}  // namespace flatspeckle::apps
