#include "apps/command/experiment.h"

#include <memory>
#include <optional>
#include <utility>

#include "core/result/collected_result.h"

namespace flatspeckle::apps {

int Experiment::run_alone(Session& session, const std::string& label) const {
  session.require_same_run(inputs_);
  const PlannedExperiment planned = plan();
  return session.run(planned.plan, {{"", label, planned.batches, stop_}}, inputs_,
                     [&](ResultFile& file) { planned.write(file, session.sums(""), true); });
}

PlannedExperiment OneShot::plan() const {
  const auto made = std::make_shared<std::optional<CollectedResult>>();
  const auto make_once = [this, made] {
    if (*made) return;
    CollectedResult result;
    ResultFile collecting(result);
    make(collecting, false);
    *made = std::move(result);
  };
  BatchJob job;
  job.size = 1;
  job.one_by_one = true;
  job.relative_error = [](const GroupedSums&) { return 0.0; };
  job.run = [make_once](std::uint64_t batch, std::span<Complex>) {
    if (batch == 0) make_once();
  };
  return {.plan = "at once",
          .batches = job,
          .write = [made, make_once](ResultFile& file, const GroupedSums&, bool) {
            make_once();
            put(file, **made);
          }};
}

int OneShot::run_alone(Session& session, const std::string&) const {
  return session.once(ResultFile(session.out(), storage()),
                      [&](ResultFile& file) { return make(file, true); });
}

}  // namespace flatspeckle::apps
