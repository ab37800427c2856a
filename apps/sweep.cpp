#include "apps/command/subcommands.h"
#include "apps/experiments/sweep_experiments.h"
#include "apps/sweep/curve_sweep.h"

namespace flatspeckle::apps {

std::unique_ptr<Call> sweep(const std::string& of) {
  return of.empty() ? curve_sweep() : sweep_of(of);
}

}  // namespace flatspeckle::apps
