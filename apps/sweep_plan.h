#pragma once

#include <optional>
#include <string>
#include <vector>

#include "apps/estimation.h"
#include "apps/run_options.h"
#include "apps/sweep_points.h"

namespace flatspeckle::apps {

/// Part `number` of `count` parts of a sweep that run apart.
struct SweepShare {
  std::size_t number = 0, count = 1;
};

/// A sweep as it was asked for. Its runs are its points by each of its methods.
struct SweepPlan {
  CommandLine command;
  SceneSpec base;
  RunSettings settings;
  MethodSettings methods;
  SweepPoints points;
  std::vector<std::string> method_words;  ///< mc, wave or both
  std::optional<SweepShare> share;

  std::size_t runs() const { return method_words.size() * points.points.size(); }
  std::size_t run(std::size_t method, std::size_t point) const {
    return method * points.points.size() + point;
  }
  const std::string& method(std::size_t run) const {
    return method_words[run / points.points.size()];
  }
  Scene scene(std::size_t run) const;
  Estimation estimation(std::size_t run, const Scene& scene) const;
  StopRule stop(std::size_t run) const;
  /// A name for the files of a run, and all that its numbers depend on: equal texts, equal numbers.
  std::string name(std::size_t run) const;
  std::string identity(std::size_t run) const;
  /// Of the sweep as a whole.
  std::string identity() const;
};

/// From the command line. Nothing if there is nothing to run (--help). Throws InputError for
/// whatever is wrong, with any of the points too.
std::optional<SweepPlan> sweep_plan(const Arguments& arguments);
/// A configuration without the keys that change no number of any run.
std::string without_keys_of_the_work(const std::string& config);
/// From a resolved configuration.
SweepPlan sweep_plan_of(const std::string& config);

}  // namespace flatspeckle::apps
