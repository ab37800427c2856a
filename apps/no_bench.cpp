#include "apps/subcommands.h"
#include "core/error.h"

namespace flatspeckle::apps {

/// Stands for bench/command/bench.cpp in a program that is built without the benchmarks.
int bench(const Arguments&) {
  throw InputError(
      "bench is not in this program: configure with -DFLATSPECKLE_BENCH=ON and build again");
}

}  // namespace flatspeckle::apps
