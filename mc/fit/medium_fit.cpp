#include "mc/fit/medium_fit.h"

#include "core/error.h"
#include "mc/fit/fit_report.h"
#include "mc/fit/model/slab_model.h"
#include "mc/fit/task/fit_data.h"

namespace flatspeckle::mc {

namespace {

using Eigen::Index;
using Eigen::VectorXd;

BoundedLeastSquares problem_of(const FitTask& task, const SlabModel& model, const FitData& data) {
  BoundedLeastSquares problem = bounds_of(task.free);
  problem.residuals = [&](const VectorXd& at) -> VectorXd {
    return data.residuals(model.values(media_at(task, at)));
  };
  problem.jacobian = [values = problem](const VectorXd& at, const VectorXd& here) {
    return jacobian(values, at, here);
  };
  return problem;
}

/// Other starts are gone on from where the best one does not end in a likely medium. The search is
/// by as many ordinates as a thousandth of the values needs; it goes on where errors ask for more.
LeastSquaresFit refined_fit(const FitTask& task, const BoundedLeastSquares& problem,
                            SlabModel& model, const FitData& data, MediumFit& fit) {
  constexpr double share = 0.05, tolerance = 1e-3, rough = 1e-3;
  const VectorXd at_first = data.errors().cwiseMax(rough * data.values().cwiseAbs());
  model.refine(media_at(task, middle(task)), at_first, share);
  auto starts = best_starts(problem, grid_of_starts(task), 3);
  LeastSquaresFit best =
      levenberg_marquardt(problem, starts.front(), task.most_iterations, tolerance);
  if (!(best.converged &&
        is_likely(best.chi_squared(), best.residuals.size(), best.parameters.size())))
    best = best_fit(problem, starts, task.most_iterations, tolerance);
  const int before = model.order();
  fit.numerical = model.refine(media_at(task, best.parameters), data.errors(), share);
  if (model.order() == before) return best;
  auto trace = std::move(best.trace);
  best = levenberg_marquardt(problem, best.parameters, task.most_iterations, tolerance);
  trace.insert(trace.end(), best.trace.begin(), best.trace.end());
  best.trace = std::move(trace);
  return best;
}

/// Of fields: least squares with errors as the best medium gives them, until that stays the same;
/// there the likelihood is largest.
LeastSquaresFit likeliest_fit(const FitTask& task, const BoundedLeastSquares& problem,
                              const SlabModel& model, LeastSquaresFit best, FitData& data) {
  constexpr int most = 20;
  constexpr double still = 1e-4, tolerance = 1e-6;  // squares, in standard errors
  for (int i = 0; i < most; ++i) {
    data = data.about(model.values(media_at(task, best.parameters)));
    LeastSquaresFit next =
        levenberg_marquardt(problem, best.parameters, task.most_iterations, tolerance);
    const VectorXd step = next.parameters - best.parameters;
    next.trace.insert(next.trace.begin(), best.trace.begin(), best.trace.end());
    best = std::move(next);
    if ((best.jacobian * step).squaredNorm() < still) return best;
  }
  best.converged = false;
  return best;
}

}  // namespace

void check(const FitTask& task) {
  const FitData data(task);
  const std::size_t free = task.free.size();
  if (static_cast<Index>(free) > data.values().size())
    throw InputError("free", free,
                     "parameters from " + std::to_string(data.values().size()) +
                         " values: must not be more than these");
  if (task.paths) return check_paths(task);
  SlabModel(curves_of(task), media_at(task, middle(task)));
}

MediumFit fit_medium(const FitTask& task) {
  if (task.paths) return fit_by_paths(task);
  FitData data(task);
  SlabModel model(curves_of(task), media_at(task, middle(task)));
  const BoundedLeastSquares problem = problem_of(task, model, data);
  MediumFit fit;
  LeastSquaresFit best = refined_fit(task, problem, model, data, fit);
  if (data.has_fields()) best = likeliest_fit(task, problem, model, std::move(best), data);
  put_information(task, information(problem, best.jacobian), best.parameters, fit);
  fit.model = model.values(media_at(task, best.parameters));
  fit.residuals = best.residuals;
  fit.pulls = (data.values() - fit.model).cwiseQuotient(data.errors());
  fit.chi_squared = best.chi_squared();
  fit.converged = best.converged;
  fit.reversed = model.reversed();
  fit.trace = best.trace;
  for (auto& step : fit.trace) step.parameters = values_at(task, step.parameters);
  return fit;
}

}  // namespace flatspeckle::mc
