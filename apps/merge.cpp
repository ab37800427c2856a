#include <filesystem>

#include "apps/command/subcommands.h"
#include "apps/experiments/experiment_sweep.h"
#include "apps/sweep/sweep.h"
#include "core/error.h"
#include "core/result/result_reader.h"

namespace flatspeckle::apps {

namespace {

/// Throws InputError if the file `out` is a complete result, which a partial result must not
/// replace.
void refuse_to_shrink(const std::string& out) {
  if (!std::filesystem::exists(out)) return;
  const ResultReader file(out);
  if (file.has_attribute("/", "complete") && file.attribute<bool>("/", "complete"))
    throw InputError(
        "out", out,
        "contains a complete sweep, which --partial does not replace: give another file");
}

struct MergeKeys {
  std::vector<std::string> folders;
  bool partial = false;
  RunSettings run;
};

void add_keys(Keys& keys, MergeKeys& values) {
  keys.group("Points");
  keys.add("shards", values.folders, "Folders of finished points (default: OUT.shards)");
  keys.add("partial", values.partial,
           "Accept missing points: write the finished points as a list instead of a grid");
  add_output_key(keys, values.run);
}

int merge_folders(const Subcommand& command, MergeKeys& values) {
  const Keys& keys = command.keys();
  const std::string& out = values.run.out;
  const Session session(command.text(), keys, values.run, command.only_prints());
  if (keys.read(values.partial)) refuse_to_shrink(out);
  keys.read(values.folders);
  if (!command.settle()) return ExitStatus::done;
  if (values.folders.empty()) values.folders = {shards_of(out)};
  const auto sweep_of = [](const std::string& config) {
    return make_sweep(value_in("of", config));
  };
  return merge_sweep(sweep_of, values.folders, out, values.partial, command.text());
}

}  // namespace

std::unique_ptr<Call> merge(const std::string&) {
  return call_with<MergeKeys>(
      "merge", "Combines the points of a sweep from one or several folders into one result",
      merge_folders);
}

}  // namespace flatspeckle::apps
