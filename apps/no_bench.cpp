#include "apps/command_line.h"
#include "apps/datasets.h"
#include "core/error.h"
#include "core/session/exit_status.h"

namespace flatspeckle::apps {

/// Stands for bench/command/bench.cpp in a program that is built without the benchmarks.
int bench(const Arguments& arguments);
int bench(const Arguments& arguments) {
  Subcommand command("bench", "Not in this program: configure with -DFLATSPECKLE_BENCH=ON");
  if (arguments.size() > 2 && arguments[2].starts_with("--") && !command.parse(arguments))
    return ExitStatus::done;
  throw InputError(
      "bench is not in this program: configure with -DFLATSPECKLE_BENCH=ON and build again");
}

std::span<const DatasetTable* const> bench_tables() {
  return {};
}

}  // namespace flatspeckle::apps
