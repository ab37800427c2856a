#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "apps/results/estimation.h"
#include "apps/sweep/sweep_points.h"
#include "core/keys/keys.h"
#include "core/session/session.h"
#include "mc/distance/detector_keys.h"
#include "mc/fit/plan/fit_plan.h"
#include "mc/fit/task/fit_task.h"

namespace flatspeckle::apps {

/// Values of the keys of the subcommand `fit`.
struct FitKeys {
  mc::MovingSpec medium;
  mc::DetectorValues detectors;
  std::vector<std::string> free, measurements, compare;
  std::int64_t starts = 2, most_iterations = 60;
  std::string method = "auto";
  double model_share = 0.2;
  bool trust_paths = false;
  bool plan = false;
  double patterns = 1000;
  std::vector<std::string> choose;
  VaryValues varied;
  RunSettings run;
};

void add_keys(Keys& keys, FitKeys& values);

/// Returns the fit that the keys request, with its measurements.
mc::FitTask task_of(const Keys& keys, const FitKeys& values, const Session& session);

/// Returns the plan of a measurement of a medium.
mc::PlanTask plan_of(const Keys& keys, const FitKeys& values, const mc::MovingSpec& medium);

/// Returns the scenes of all measurements, with lights and views from the measurements and the free
/// parameters in the middle of their bounds.
std::vector<SceneSpec> middle_scenes(const mc::FitTask& task);

}  // namespace flatspeckle::apps
