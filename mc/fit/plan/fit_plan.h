#pragma once

#include <string>
#include <vector>

#include <Eigen/Core>

#include "core/result/dataset_row.h"
#include "core/result/result_file.h"
#include "mc/fit/task/free_parameter.h"

namespace flatspeckle::mc {

/// What would be measured: fields of a view under a light at rest and tilted (matched views), in
/// independent patterns, their scale unknown.
struct PlanTask {
  std::vector<FreeParameter> free;  ///< with a start each: where the plan is made
  MovingSpec scene;                 ///< of a slab, covariance = memory_effect
  double patterns = 1;
};

struct FitPlan {
  Eigen::VectorXd values, errors;
  Eigen::MatrixXd correlation;
  double condition = 0;
  Eigen::VectorXd patterns_to_percent;  ///< that make an error a hundredth of the value
  std::vector<double> views, tilts;
  Eigen::MatrixXd without_view, without_tilt;  ///< errors over those of all; [left out][parameter]
};

/// The Fisher information of circular Gaussian fields, tr(C^-1 C_a C^-1 C_b) of each pattern and
/// view (Slepian 1954, Bangs 1971), less what an unknown scale of each view takes away; the bound
/// is its inverse. Throws InputError.
FitPlan fit_plan(const PlanTask& task);

/// Of fields of covariance C with derivatives, their scale unknown: [parameter][parameter].
Eigen::MatrixXd field_information(const Eigen::MatrixXcd& covariance,
                                  const std::vector<Eigen::MatrixXcd>& slopes);

extern const DatasetTable plan_table;
void write_plan(ResultFile& file, const PlanTask& task, const FitPlan& plan);

/// A plan of the same free keys at each of several points.
struct PlanPoint {
  std::string name;
  FitPlan plan;
};
void write_plans(ResultFile& file, const PlanTask& task, const std::vector<PlanPoint>& points);

}  // namespace flatspeckle::mc
