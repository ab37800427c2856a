#pragma once

#include <memory>
#include <string>
#include <vector>

#include "apps/experiments/experiment_kind.h"
#include "apps/sweep/sweep.h"

namespace flatspeckle::apps {

/// A sweep of any subcommand that makes one result. At each point of the sweep, the subcommand is
/// run with other values of some keys and the same seed.
class ExperimentSweep : public Sweep {
 public:
  /// Throws InputError for the name of a subcommand that cannot be swept.
  explicit ExperimentSweep(const std::string& of);

  /// Returns the definition of the key that varies along an axis.
  const Key& key(const SweepAxis& axis) const { return *keys().find(key_of(axis)); }

  SweepRun open(std::size_t point) const override;
  std::string identity_of_points() const override;
  std::string identity() const override;
  /// Writes the results of all points, combined: each dataset has the axes of the sweep in front of
  /// its own axes. These are the swept keys if all points of a grid are finished, and otherwise a
  /// single axis `point`. Also writes the costs of each point. Datasets that some points lack or
  /// have in another shape are left out and listed in an attribute. If a point has no marks of
  /// undersampled values, they are written as 0.
  void write(ResultFile& file, const PointStore& store) const override;

 private:
  /// Checks the values of all points. If there are very many points, makes and checks only some of
  /// the scenes.
  void check() override;
  void check_points();
  std::vector<std::size_t> points_to_check() const;
  std::unique_ptr<Experiment> experiment(std::size_t point,
                                         const std::vector<const Keys*>& also_marked = {}) const;

  ExperimentKind kind_;
  std::unique_ptr<Experiment> base_;
  std::string inputs_;
};

/// Makes a sweep of the subcommand `of`, or of memory-effect curves if `of` is empty. Throws
/// InputError if the subcommand cannot be swept.
std::unique_ptr<Sweep> make_sweep(const std::string& of);

}  // namespace flatspeckle::apps
