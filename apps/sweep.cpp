#include "apps/command/subcommands.h"
#include "apps/experiments/sweep_experiments.h"
#include "apps/sweep/curve_sweep.h"

namespace flatspeckle::apps {

int sweep(const Arguments& arguments) {
  const std::string of = swept_subcommand(arguments);
  return of.empty() ? curve_sweep(arguments) : sweep_experiments(of, arguments);
}

}  // namespace flatspeckle::apps
