#include "apps/experiments/single_run.h"

#include "core/session/session.h"

namespace flatspeckle::apps {

int single_run(const std::string& name, const Arguments& arguments) {
  const ExperimentEntry& entry = *experiment_entry(name);
  const auto experiment = entry.make();
  Subcommand command(name, entry.purpose);
  experiment->add_keys(command.keys());
  if (!command.parse(arguments)) return ExitStatus::done;

  Session session(command.text(), command.keys(), experiment->run(), command.only_prints());
  experiment->read(command.keys());
  if (!command.settle()) return ExitStatus::done;
  const PlannedExperiment planned = experiment->plan();
  const auto& write = planned.write_and_tell ? planned.write_and_tell : planned.write;
  return session.run(planned.plan, {{"", name, planned.batches, experiment->stop()}},
                     experiment->inputs(),
                     [&](ResultFile& file) { write(file, session.sums("")); });
}

}  // namespace flatspeckle::apps
