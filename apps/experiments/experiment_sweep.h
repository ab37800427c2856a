#pragma once

#include <memory>
#include <string>
#include <vector>

#include "apps/experiments/experiment_family.h"
#include "apps/sweep/sweep.h"

namespace flatspeckle::apps {

/// A sweep of any subcommand that makes one result. Each point is a run of it with some keys at
/// other values, and the same seed.
class ExperimentSweep : public Sweep {
 public:
  /// Throws InputError for the name of what cannot be swept.
  explicit ExperimentSweep(const std::string& of);

  /// The row of the key that an axis sets.
  const Key& key(const SweepAxis& axis) const { return *keys().find(key_of(axis)); }

  SweepRun open(std::size_t point) const override;
  std::string identity_of_points() const override;
  std::string identity() const override;
  /// Each dataset with the swept axes in front of its own where all points of a grid are there,
  /// else with `point` in front, and the costs of each point. What only some points have, or in
  /// other shapes, is left out and named in an attribute; but marks of rare paths, which are 0
  /// where there are none.
  void write(ResultFile& file, const PointStore& store) const override;

 private:
  /// Checks only some points in full where there are very many.
  void check() override;
  void check_points();
  std::vector<std::size_t> points_to_check() const;
  std::unique_ptr<Experiment> experiment(std::size_t point,
                                         const std::vector<const Keys*>& joined = {}) const;

  ExperimentFamily family_;
  std::unique_ptr<Experiment> base_;
  std::string inputs_;
};

/// A sweep of this subcommand's results, or, where it is empty, of memory-effect curves. Throws
/// InputError for the name of what cannot be swept.
std::unique_ptr<Sweep> make_sweep(const std::string& of);

}  // namespace flatspeckle::apps
