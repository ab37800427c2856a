#include "apps/command/subcommands.h"
#include "apps/experiments/sweep_experiments.h"
#include "apps/sweep/run_sweep.h"

namespace flatspeckle::apps {

int sweep(const Arguments& arguments) {
  const auto sweep = make_sweep(swept_subcommand(arguments));
  return sweep->parse(arguments) ? run_sweep(*sweep) : ExitStatus::done;
}

}  // namespace flatspeckle::apps
