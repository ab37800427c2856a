#include <filesystem>

#include "apps/command/subcommands.h"
#include "apps/experiments/sweep_experiments.h"
#include "apps/sweep/run_sweep.h"
#include "core/error.h"
#include "core/result/result_reader.h"

namespace flatspeckle::apps {

namespace {

/// A part must not take the place of a whole.
void refuse_to_shrink(const std::string& out) {
  if (!std::filesystem::exists(out)) return;
  const ResultReader file(out);
  if (file.has_attribute("/", "complete") && file.attribute<bool>("/", "complete"))
    throw InputError("out", out, "holds a complete sweep; --partial does not replace one");
}

}  // namespace

int merge(const Arguments& arguments) {
  RunSettings run;
  std::vector<std::string> folders;
  bool partial = false;
  Subcommand command("merge", "The points of a sweep, from one or several folders, as one result");
  Keys& keys = command.keys();
  keys.group("Points");
  keys.add("shards", folders, "Folders of points (default OUT.shards)");
  keys.add("partial", partial, "Take the points that are there, as a list");
  add_output_key(keys, run);
  if (!command.parse(arguments)) return ExitStatus::done;
  const Session session(command.text(), keys, run, command.only_prints());
  if (keys.read(partial)) refuse_to_shrink(run.out);
  keys.read(folders);
  if (!command.settle()) return ExitStatus::done;
  if (folders.empty()) folders = {shards_of(run.out)};
  return merge_sweep(sweep_of_config, folders, run.out, partial, command.text());
}

}  // namespace flatspeckle::apps
