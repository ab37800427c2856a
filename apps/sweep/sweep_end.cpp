#include "apps/sweep/sweep_end.h"

#include <algorithm>
#include <iostream>
#include <set>

#include "apps/results/datasets.h"
#include "apps/sweep/sweep_table.h"
#include "core/error.h"
#include "core/result/result_group.h"
#include "core/run/ranks.h"

namespace flatspeckle::apps {

namespace {

using Part = ShardFolder::Part;

/// How the whole was made: the costs of all points, and each plan once. Converged: all that are
/// there.
Provenance made_of(const SweepPlan& plan, const SweepResults& results, double wall_s) {
  Provenance made = plan.session().provenance();
  made.identity = plan.identity();
  made.wall_s = wall_s;
  made.converged = true;
  std::set<std::string> plans;
  for (const auto& result : results) {
    if (!result) continue;
    made.converged = made.converged && result->reached;
    plans.insert(result->plan);
    made.started = std::min(made.started, result->started);
    made.cpu_s += result->cpu_s;
    made.samples += result->samples;
  }
  for (const std::string& text : plans) made.plan += (made.plan.empty() ? "" : "\n") + text;
  return made;
}

bool is_whole(const SweepResults& results) {
  return std::all_of(results.begin(), results.end(), [](const auto& result) { return result; });
}

std::string count_text(const SweepPlan& plan, const SweepResults& results) {
  return std::to_string(finished_points(plan, results).size()) + " of " +
         std::to_string(plan.points.count()) + " points";
}

}  // namespace

std::string shards_of(const std::string& out) {
  return out + ".shards";
}

SweepResults gather(const SweepPlan& plan, const std::vector<std::string>& folders,
                    std::ostream& warnings) {
  SweepResults results(plan.runs());
  for (const std::string& path : folders) {
    ShardFolder folder(path);
    for (std::size_t run = 0; run < results.size(); ++run) {
      const std::string name = plan.name(run);
      if (results[run] || !folder.has(name, Part::finished)) continue;
      const auto wrong =
          folder.read(name, Part::finished, plan.identity(run), [&](const ResultReader& file) {
            PointResult point = read_point(file);
            if (point.correlation.size() != plan.base.tilts.size())
              throw InputError("field_correlation is of other tilts");
            results[run] = std::move(point);
          });
      if (wrong) warnings << "warning: " << path << ": " << name << ' ' << *wrong << '\n';
    }
  }
  return results;
}

int write_result(const SweepPlan& plan, const SweepResults& results, double wall_s) {
  Provenance made = made_of(plan, results, wall_s);
  const bool all_reached = made.converged;
  made.converged = all_reached && is_whole(results);
  print_ranges(plan, results);
  ResultFile file(plan.settings.out);
  const ResultGroup root(file, sweep_table);
  root.attribute("format", std::uint64_t{2});
  root.attribute("complete", is_whole(results));
  root.attribute("ranks", std::int64_t{ranks().size});
  write_sweep(file, plan, results);
  std::cout << count_text(plan, results) << '\n';
  Session::commit(file, made);
  if (!all_reached) std::cout << "not every point has reached its target error\n";
  return made.converged ? ExitStatus::done : ExitStatus::error_not_reached;
}

void remove_points(const SweepPlan& plan, const SweepResults& results, const ShardFolder& folder) {
  std::set<std::string> names;
  for (std::size_t run = 0; run < results.size(); ++run)
    if (results[run]) names.insert(plan.name(run));
  folder.remove(names);
}

int end_sweep(const SweepPlan& plan, ShardFolder& folder, const PoolEnd& end) {
  const std::string place = folder.path().string();
  const SweepResults results = gather(plan, {place}, std::cerr);
  if (plan.share || end.reason == StopReason::interrupted) {
    const bool interrupted = end.reason == StopReason::interrupted;
    std::cout << (interrupted ? "interrupted; " : "") << place << " holds "
              << count_text(plan, results);
    std::cout << (is_whole(results)                   ? "; `flatspeckle merge` makes the result\n"
                  : end.reason == StopReason::samples ? "; this share is done\n"
                                                      : "; --resume goes on\n");
    if (interrupted) return ExitStatus::interrupted_resumable;
    return end.reason == StopReason::samples ? ExitStatus::done : ExitStatus::error_not_reached;
  }
  int status = ExitStatus::error_not_reached;
  if (!finished_points(plan, results).empty()) status = write_result(plan, results, end.wall_s);
  if (is_whole(results)) {
    remove_points(plan, results, folder);
  } else {
    std::cout << place << " holds " << count_text(plan, results) << "; --resume goes on\n";
  }
  return status;
}

}  // namespace flatspeckle::apps
