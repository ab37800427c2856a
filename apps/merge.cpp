#include <filesystem>
#include <iostream>

#include "apps/subcommands.h"
#include "apps/sweep_end.h"
#include "core/atomic_file.h"
#include "core/error.h"
#include "core/sealed_file.h"
#include "core/stopwatch.h"

namespace flatspeckle::apps {

namespace {

namespace fs = std::filesystem;

bool is_shard(const fs::path& path) {
  return path.extension() == ".h5" && path.stem().extension() != ".part" && is_sealed(path);
}

/// The configuration of the sweep that the folders hold points of.
std::string config_of(const std::vector<std::string>& folders) {
  for (const std::string& folder : folders) {
    if (!fs::is_directory(folder)) throw InputError("shards", folder, "is not a folder");
    for (const auto& entry : fs::directory_iterator(folder))
      if (is_shard(entry.path()))
        return ResultReader(entry.path()).attribute<std::string>("/", "config");
  }
  throw InputError("shards", folders.front(), "holds no finished points of a sweep");
}

void require_all(const SweepPlan& plan, const SweepResults& results) {
  std::size_t missing = 0, first = 0;
  for (std::size_t run = results.size(); run-- > 0;)
    if (!results[run]) ++missing, first = run;
  if (missing > 0)
    throw InputError(std::to_string(missing) + " of " + std::to_string(results.size()) +
                     " points are missing, " + plan.name(first) +
                     " among them; --partial takes what there is");
}

}  // namespace

int merge(const Arguments& arguments) {
  const Stopwatch clock;
  RunSettings settings;
  std::vector<std::string> folders;
  bool partial = false;
  Subcommand command("merge", "The points of a sweep, from one or several folders, as one result");
  command.options().add_option("--shards", folders, "Folders of points (default OUT.shards)");
  command.options().add_flag("--partial", partial, "Take the points that are there, as a list");
  add_output_option(command.options(), settings);
  if (!command.parse(arguments)) return ExitStatus::done;
  if (settings.out.empty())
    throw InputError("out is not given: name the result file (--out FILE.h5)");
  check_writable(settings.out);
  if (folders.empty()) folders = {shards_of(settings.out)};

  SweepPlan plan = sweep_plan_of(config_of(folders));
  plan.command.text = command.command_line().text;
  plan.settings.out = settings.out;
  const SweepResults results = gather(plan, folders);
  if (!partial) require_all(plan, results);
  if (finished_points(plan, results).empty())
    throw InputError("shards", folders.front(), "no point is finished by every method");
  return write_result(plan, results, clock.seconds());
}

}  // namespace flatspeckle::apps
