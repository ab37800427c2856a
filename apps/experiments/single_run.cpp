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
  experiment->note();
  return experiment->run_alone(session, name);
}

}  // namespace flatspeckle::apps
