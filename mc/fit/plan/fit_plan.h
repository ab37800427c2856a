#pragma once

#include <cstddef>
#include <functional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "core/result/dataset_row.h"
#include "core/result/result_file.h"
#include "mc/fit/task/free_parameter.h"

namespace flatspeckle::mc {

/// A plan for measuring fields in several detection directions. The illumination has its original
/// angle in one measurement and is tilted in the others, with matched views. All are repeated in
/// independent patterns. The scale of the fields is unknown.
struct PlanTask {
  std::vector<FreeParameter> free;  ///< each with a start, the value for which the plan is made
  MovingSpec scene;                 ///< a slab, with covariance = memory_effect
  double patterns = 1;
  /// Numbers of views and tilts to choose among those of the scene; 0: all of them. Those whose
  /// omission increases the sum of the squared relative errors least are left out, one by one.
  std::size_t most_views = 0, most_tilts = 0;
  /// Called after each solution of transport with the numbers of finished and of all solutions.
  std::function<void(std::size_t, std::size_t)> solved{};
};

struct FitPlan {
  Eigen::VectorXd values, errors;
  Eigen::MatrixXd correlation;
  double condition = 0;
  /// Number of patterns that reduces each error to a hundredth of the value.
  Eigen::VectorXd patterns_to_percent;
  std::vector<double> views, tilts;  ///< those chosen, in the order of the scene
  /// Errors divided by those with all views and tilts of the scene.
  Eigen::VectorXd growth_by_choice;
  /// Errors if one view or one tilt is left out, divided by the errors without omission,
  /// [left out][parameter].
  Eigen::MatrixXd without_view, without_tilt;
};

/// Returns the Cramer-Rao bound of the errors: the inverse of the Fisher information of circular
/// Gaussian fields. For parameters a and b, each pattern and view contributes tr(C^-1 C_a C^-1 C_b)
/// to the information, where C_a and C_b are derivatives of the covariance C (Slepian
/// [slepian1954], Bangs [bangs1971]), less the information that the unknown scale of each view
/// removes. Throws InputError.
FitPlan fit_plan(const PlanTask& task);

/// Returns the Fisher information, [parameter][parameter], of fields with this covariance and an
/// unknown scale. derivatives: derivatives of the covariance by each parameter.
Eigen::MatrixXd field_information(const Eigen::MatrixXcd& covariance,
                                  const std::vector<Eigen::MatrixXcd>& derivatives);

extern const DatasetTable plan_table;
void write_plan(ResultFile& file, const PlanTask& task, const FitPlan& plan);

/// The plan for one of several points, at which some scene keys have different values. All points
/// have the same free keys.
struct PlanPoint {
  std::string name;
  FitPlan plan;
};
void write_plans(ResultFile& file, const PlanTask& task, const std::vector<PlanPoint>& points);

}  // namespace flatspeckle::mc
