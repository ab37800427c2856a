#pragma once

#include <functional>
#include <memory>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "apps/command/experiment.h"
#include "apps/command/subcommands.h"
#include "apps/sweep/sweep_points.h"
#include "core/error.h"

namespace flatspeckle::apps {

/// Returns work(). If it throws InputError, the name of the point is put before the message.
template <class Work>
decltype(auto) at_point(const SweepPoints& points, std::size_t point, const Work& work) try {
  return work();
} catch (const InputError& error) {
  throw InputError("point " + points.name(point) + ": " + error.what());
}

/// Returns the plan of the experiment at a point. If later its batches or the writing of its result
/// throw InputError, the message begins with the name of the point. `points` must exist as long as
/// the plan.
inline PlannedExperiment plan_at(const SweepPoints& points, std::size_t point,
                                 const Experiment& experiment) {
  return at_point(points, point, [&] {
    PlannedExperiment planned = experiment.plan();
    planned.batches.run = [&points, point, run = std::move(planned.batches.run)](
                              std::uint64_t batch, std::span<Complex> sums) {
      at_point(points, point, [&] { run(batch, sums); });
    };
    planned.write = [&points, point, write = std::move(planned.write)](
                        ResultFile& file, const GroupedSums& sums, bool prints) {
      at_point(points, point, [&] { write(file, sums, prints); });
    };
    return planned;
  });
}

/// Replaces the keys of a single run by those of a series of runs: out, seed, threads, seconds (the
/// total time) and resume. The keys of the other stop criteria remain; they apply to each run.
void add_run_keys_of_many(Keys& keys, RunSettings& run);

/// Makes many runs of one subcommand, which differ in a few keys and share the values of all
/// others.
class ExperimentKind {
 public:
  /// of: name of the subcommand. Throws InputError unless it is a subcommand that makes one result.
  explicit ExperimentKind(const std::string& of);

  const std::string& of() const { return of_; }
  const char* purpose() const { return entry_->title; }
  /// Returns an experiment with all keys at their defaults.
  std::unique_ptr<Experiment> unset() const { return entry_->experiment(); }

  /// Takes the values of all given keys, except those in `without`, as the values that all runs
  /// share.
  void take_given(const Keys& keys, std::set<std::string> without);
  void set_given(const Keys& keys) const;
  /// Returns the keys and values that all runs share as text.
  std::string given() const;

  /// Returns a new run with the shared values and the keys that `set` sets. also_marked: other sets
  /// of keys, in which all keys that the run reads are marked as read. seed: default seed. Throws
  /// InputError.
  std::unique_ptr<Experiment> run(const std::function<void(const Keys&)>& set,
                                  const std::vector<const Keys*>& also_marked = {},
                                  std::uint64_t seed = 1) const;

 private:
  std::string of_;
  const SubcommandEntry* entry_;
  std::vector<std::pair<std::string, std::vector<std::string>>> given_;
};

}  // namespace flatspeckle::apps
