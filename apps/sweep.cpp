#include <algorithm>
#include <filesystem>
#include <iostream>
#include <numeric>

#include "apps/shard_folder.h"
#include "apps/subcommands.h"
#include "apps/sweep_end.h"
#include "apps/sweep_plan.h"
#include "apps/sweep_work.h"
#include "core/atomic_file.h"
#include "core/error.h"
#include "core/interrupt.h"

namespace flatspeckle::apps {

namespace {

using Part = ShardFolder::Part;

bool is_complete(const SweepPlan& plan) {
  const std::string& out = plan.settings.out;
  if (!plan.settings.resume || !std::filesystem::exists(out)) return false;
  const ResultReader file(out);
  if (!file.has_attribute("/", "identity") ||
      file.attribute<std::string>("/", "identity") != plan.identity())
    throw InputError("resume: " + out + " holds another run; name another result file");
  return file.attribute<bool>("/", "complete");
}

/// The runs of this process's share, scattered over the grid, so that what has been done at any
/// time says something about what is left.
std::vector<std::size_t> share_of_runs(const SweepPlan& plan) {
  const std::size_t count = plan.runs();
  std::size_t stride = std::max<std::size_t>(1, count * 618 / 1000);
  while (std::gcd(stride, count) != 1) ++stride;
  const SweepShare share = plan.share.value_or(SweepShare{});
  std::vector<std::size_t> runs;
  for (std::size_t i = share.number; i < count; i += share.count)
    runs.push_back(i * stride % count);
  return runs;
}

bool is_finished(const SweepPlan& plan, ShardFolder& folder, std::size_t run) {
  const std::string name = plan.name(run);
  if (!folder.has(name, Part::finished)) return false;
  const auto wrong = folder.read(name, Part::finished, plan.identity(run),
                                 [](const ResultReader& file) { read_point(file); });
  if (wrong) folder.set_aside(name, Part::finished, *wrong);
  return !wrong;
}

/// Runs that are left to do. Throws InputError where an earlier sweep would be overwritten.
std::vector<std::size_t> left_to_do(const SweepPlan& plan, ShardFolder& folder) {
  auto runs = share_of_runs(plan);
  if (plan.settings.resume) {
    std::erase_if(runs, [&](std::size_t run) { return is_finished(plan, folder, run); });
    return runs;
  }
  for (std::size_t run : runs)
    if (folder.has(plan.name(run), Part::finished) || folder.has(plan.name(run), Part::unfinished))
      throw InputError(folder.path().string() +
                       " holds points of a sweep that has not ended: --resume goes on with them; "
                       "remove the folder to begin again");
  return runs;
}

}  // namespace

int sweep(const Arguments& arguments) {
  const auto plan = sweep_plan(arguments);
  if (!plan) return ExitStatus::done;
  const std::string& out = plan->settings.out;
  if (out.empty()) throw InputError("out is not given: name the result file (--out FILE.h5)");
  check_writable(out);
  if (is_complete(*plan)) {
    std::cout << out << " is complete; nothing to resume\n";
    return ExitStatus::done;
  }
  catch_interrupts();
  ShardFolder folder(shards_of(out));
  SweepWork work(*plan, folder, left_to_do(*plan, folder));
  folder.make();
  const PoolEnd end = run_pool(
      work.list(), {plan->settings.seconds, threads_of(plan->settings), "sweep", "points"});
  work.save_unfinished();
  return end_sweep(*plan, folder, end);
}

}  // namespace flatspeckle::apps
