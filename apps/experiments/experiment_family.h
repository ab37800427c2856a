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

/// What is done for one of the points, which an InputError then names.
template <class Work>
decltype(auto) at_point(const SweepPoints& points, std::size_t point, const Work& work) try {
  return work();
} catch (const InputError& error) {
  throw InputError("point " + points.name(point) + ": " + error.what());
}

/// The plan of its experiment, with batches and a result that name it too. The points stay.
inline PlannedExperiment plan_at(const SweepPoints& points, std::size_t point,
                                 const Experiment& experiment) {
  return at_point(points, point, [&] {
    PlannedExperiment planned = experiment.plan();
    planned.batches.run = [&points, point, run = std::move(planned.batches.run)](
                              std::uint64_t batch, std::span<Complex> sums) {
      at_point(points, point, [&] { run(batch, sums); });
    };
    planned.write = [&points, point, write = std::move(planned.write)](
                        ResultFile& file, const GroupedSums& sums, bool tells) {
      at_point(points, point, [&] { write(file, sums, tells); });
    };
    return planned;
  });
}

/// In place of those of a single run, for many: where the result goes, the seed, on what and how
/// long to work, whether to go on. How long each runs stays a key of its own.
void add_run_keys_of_many(Keys& keys, RunSettings& run);

/// Runs of one subcommand that have most keys alike.
class ExperimentFamily {
 public:
  /// Throws InputError for the name of what makes no result of its own.
  explicit ExperimentFamily(const std::string& of);

  const std::string& of() const { return of_; }
  const char* purpose() const { return entry_->title; }
  /// With all keys at their defaults.
  std::unique_ptr<Experiment> unset() const { return entry_->experiment(); }

  /// What all runs have: all that is given here, but for some keys.
  void take_given(const Keys& keys, std::set<std::string> without);
  void set_given(const Keys& keys) const;
  /// As text.
  std::string given() const;

  /// A run of its own, after `set` has set further keys. joined: count as read what it reads. seed:
  /// where none is given. Throws InputError.
  std::unique_ptr<Experiment> run(const std::function<void(const Keys&)>& set,
                                  const std::vector<const Keys*>& joined = {},
                                  std::uint64_t seed = 1) const;

 private:
  std::string of_;
  const SubcommandEntry* entry_;
  std::vector<std::pair<std::string, std::vector<std::string>>> given_;
};

}  // namespace flatspeckle::apps
