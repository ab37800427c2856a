#include "apps/sweep/merge_points.h"

#include <algorithm>
#include <filesystem>
#include <iostream>
#include <set>
#include <sstream>

#include "apps/sweep/sweep_end.h"
#include "core/error.h"
#include "core/result/sealed_file.h"
#include "core/run/stopwatch.h"

namespace flatspeckle::apps {

namespace {

namespace fs = std::filesystem;

bool is_shard(const fs::path& path) {
  return path.extension() == ".h5" && path.stem().extension() != ".part" && is_sealed(path);
}

/// The lines of a configuration less those of some keys.
std::string without_keys(const std::string& config, const std::set<std::string>& keys) {
  std::istringstream lines(config);
  std::string kept, line;
  while (std::getline(lines, line))
    if (!keys.contains(line.substr(0, line.find(" = ")))) kept += line + '\n';
  return kept;
}

/// The configurations of the sweeps that the folders hold points of, each once.
std::set<std::string> configs_of(const std::vector<std::string>& folders) {
  std::set<std::string> configs;
  for (const std::string& folder : folders) {
    if (std::error_code none; !fs::is_directory(folder, none))
      throw InputError("shards", folder, "is not a folder");
    for (const auto& entry : fs::directory_iterator(folder))
      if (is_shard(entry.path()))
        configs.insert(without_keys(
            ResultReader(entry.path()).attribute<std::string>("/", "config"), keys_of_the_work));
  }
  if (configs.empty())
    throw InputError("shards", folders.front(), "holds no finished points of a sweep");
  return configs;
}

/// A sweep and what the folders hold of it.
struct Found {
  std::shared_ptr<SweepPlan> plan;
  SweepResults results;
  std::string warnings;

  auto points() const {
    return std::count_if(results.begin(), results.end(), [](const auto& point) { return point; });
  }
};

/// The sweep that most points are of: strays may lie among them, and points of a smaller grid that
/// has grown.
Found most_of(const std::vector<std::string>& folders, const std::string& command_line) {
  Found most;
  for (const std::string& config : configs_of(folders)) {
    Found found{std::make_shared<SweepPlan>(), {}, {}};
    found.plan->parse_config(config, command_line);
    std::ostringstream warnings;
    found.results = gather(*found.plan, folders, warnings);
    found.warnings = warnings.str();
    if (!most.plan || found.points() > most.points()) most = std::move(found);
  }
  return most;
}

/// Tells of points that are left out because this sweep has no such points.
void tell_of_strangers(const SweepPlan& plan, const std::vector<std::string>& folders) {
  std::set<std::string> own;
  for (std::size_t run = 0; run < plan.runs(); ++run) own.insert(plan.name(run));
  for (const std::string& folder : folders) {
    const auto strangers = std::count_if(
        fs::directory_iterator(folder), fs::directory_iterator{}, [&](const auto& entry) {
          return is_shard(entry.path()) && !own.contains(entry.path().stem().string());
        });
    if (strangers > 0)
      std::cerr << "warning: " << folder << ": " << strangers
                << " points of another sweep are left out\n";
  }
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

int merge_points(const std::vector<std::string>& folders, const std::string& out, bool partial,
                 const std::string& command_line) {
  const Stopwatch clock;
  auto [owned, results, warnings] = most_of(folders, command_line);
  SweepPlan& plan = *owned;
  std::cerr << warnings;
  tell_of_strangers(plan, folders);
  plan.settings.out = out;
  if (!partial) require_all(plan, results);
  if (finished_points(plan, results).empty())
    throw InputError("shards", folders.front(), "no point is finished by every method");
  return write_result(plan, results, clock.seconds());
}

}  // namespace flatspeckle::apps
