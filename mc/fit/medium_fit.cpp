#include "mc/fit/medium_fit.h"

#include <cmath>
#include <numeric>

#include <Eigen/Cholesky>

#include "core/error.h"
#include "mc/fit/derived.h"
#include "mc/fit/slab_model.h"

namespace flatspeckle::mc {

namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

std::vector<Curve> curves_of(const FitTask& task) {
  std::vector<Curve> curves;
  for (const Measurement& one : task.measurements)
    curves.insert(curves.end(), one.curves.begin(), one.curves.end());
  return curves;
}

std::vector<Scene> scenes_at(const FitTask& task, const VectorXd& coordinates) {
  std::vector<Scene> scenes;
  for (const Measurement& one : task.measurements)
    for (const Curve& curve : one.curves)
      scenes.push_back(scene_of(with_parameters(curve.scene, task.free, coordinates)));
  return scenes;
}

/// Where parameters start, or amid their bounds.
VectorXd middle(const FitTask& task) {
  VectorXd at = (lower_coordinates(task.free) + upper_coordinates(task.free)) / 2;
  for (std::size_t i = 0; i < task.free.size(); ++i)
    if (const auto& start = task.free[i].start)
      at[static_cast<Index>(i)] = task.free[i].coordinate(*start);
  return at;
}

/// All measurements as one, their errors made independent.
class Data {
 public:
  explicit Data(const FitTask& task) {
    Index size = 0;
    for (const Measurement& one : task.measurements) size += one.values.size();
    values_.resize(size);
    errors_.resize(size);
    Index first = 0;
    for (const Measurement& one : task.measurements) {
      values_.segment(first, one.values.size()) = one.values;
      errors_.segment(first, one.values.size()) = one.covariance.diagonal().cwiseSqrt();
      roots_.emplace_back(one.covariance);
      if (roots_.back().info() != Eigen::Success)
        throw InputError("measurement", one.name,
                         "the covariance of its errors must be positive definite");
      first += one.values.size();
    }
  }

  const VectorXd& values() const { return values_; }
  const VectorXd& errors() const { return errors_; }
  VectorXd residuals(const VectorXd& model) const { return whitened(model - values_); }
  /// Of each column: L^-1, where L L^T is the covariance.
  MatrixXd whitened(const MatrixXd& of) const {
    MatrixXd white(of.rows(), of.cols());
    Index first = 0;
    for (const auto& root : roots_) {
      white.middleRows(first, root.rows()) =
          root.matrixL().solve(of.middleRows(first, root.rows()));
      first += root.rows();
    }
    return white;
  }

 private:
  VectorXd values_, errors_;
  std::vector<Eigen::LLT<MatrixXd>> roots_;
};

/// Differences towards the middle, for a bound may be the end of what can be computed.
MatrixXd jacobian(const LeastSquares& problem, const VectorXd& at, const VectorXd& here) {
  constexpr double step = 1e-3;  // of the distance of the bounds
  MatrixXd slopes(here.size(), at.size());
  for (Index i = 0; i < at.size(); ++i) {
    const double range = problem.upper[i] - problem.lower[i],
                 sign = 2 * at[i] > problem.lower[i] + problem.upper[i] ? -1 : 1;
    VectorXd next = at;
    next[i] += sign * step * range;
    slopes.col(i) = (problem.residuals(next) - here) / (next[i] - at[i]);
  }
  return slopes;
}

LeastSquares problem_of(const FitTask& task, const SlabModel& model, const Data& data) {
  LeastSquares problem;
  problem.lower = lower_coordinates(task.free);
  problem.upper = upper_coordinates(task.free);
  problem.residuals = [&](const VectorXd& at) -> VectorXd {
    return data.residuals(model.values(scenes_at(task, at)));
  };
  problem.jacobian = [values = problem](const VectorXd& at, const VectorXd& here) {
    return jacobian(values, at, here);
  };
  return problem;
}

/// All combinations of the parameters' starts.
std::vector<VectorXd> grid_of_starts(const FitTask& task, const LeastSquares& problem) {
  std::vector<VectorXd> starts{middle(task)};
  for (std::size_t i = 0; i < task.free.size(); ++i) {
    if (task.free[i].start) continue;
    const auto j = static_cast<Index>(i);
    std::vector<VectorXd> more;
    for (const VectorXd& start : starts)
      for (int n = 0; n < task.starts; ++n) {
        more.push_back(start);
        more.back()[j] =
            problem.lower[j] + (n + 0.5) / task.starts * (problem.upper[j] - problem.lower[j]);
      }
    starts = std::move(more);
  }
  return starts;
}

VectorXd values_at(const FitTask& task, const VectorXd& coordinates) {
  VectorXd values = coordinates;
  for (Index i = 0; i < values.size(); ++i)
    values[i] = task.free[static_cast<std::size_t>(i)].value(coordinates[i]);
  return values;
}

VectorXd slopes_at(const FitTask& task, const VectorXd& coordinates) {
  VectorXd slopes = coordinates;
  for (Index i = 0; i < slopes.size(); ++i)
    slopes[i] = task.free[static_cast<std::size_t>(i)].slope(coordinates[i]);
  return slopes;
}

/// Of the first curve's medium.
std::vector<Derived> derived_at(const FitTask& task, const VectorXd& at,
                                const MatrixXd& covariance) {
  const SceneSpec& spec = task.measurements.front().curves.front().scene;
  const auto scene = [&](const VectorXd& x) {
    return scene_of(with_parameters(spec, task.free, x));
  };
  const VectorXd range = upper_coordinates(task.free) - lower_coordinates(task.free);
  const auto rows = static_cast<Index>(derived_rows.size());
  const auto values = [&](const VectorXd& x) {
    const Scene of = scene(x);
    VectorXd found(rows);
    for (Index r = 0; r < rows; ++r) found[r] = derived_rows[static_cast<std::size_t>(r)].value(of);
    return found;
  };
  LeastSquares as_problem{values, {}, lower_coordinates(task.free), upper_coordinates(task.free)};
  const VectorXd here = values(at);
  const MatrixXd slopes = jacobian(as_problem, at, here);
  const VectorXd error = (slopes * covariance * slopes.transpose()).diagonal().cwiseSqrt();
  std::vector<Derived> derived;
  for (Index r = 0; r < rows; ++r) {
    const DerivedRow& row = derived_rows[static_cast<std::size_t>(r)];
    derived.push_back({row.name, row.unit, here[r], error[r]});
  }
  return derived;
}

void put_information(const FitTask& task, const LeastSquares& problem, const LeastSquaresFit& at,
                     MediumFit& fit) {
  const Information known = information(problem, at.jacobian);
  const VectorXd slopes = slopes_at(task, at.parameters);
  fit.estimates = values_at(task, at.parameters);
  fit.covariance = slopes.asDiagonal() * known.covariance * slopes.asDiagonal();
  fit.errors = fit.covariance.diagonal().cwiseSqrt();
  fit.correlation = known.correlation;
  fit.condition = known.condition;
  fit.worst = known.worst;
  const VectorXd share = known.errors().cwiseQuotient(problem.upper - problem.lower);
  for (const double one : share) fit.known.push_back(one < 0.25);
  fit.derived = derived_at(task, at.parameters, known.covariance);
}

/// Whether chi^2 is no more than noise makes it, to four standard deviations.
bool is_likely(const LeastSquaresFit& fit) {
  const auto degrees = static_cast<double>(fit.residuals.size() - fit.parameters.size());
  return fit.chi_squared() < degrees + 4 * std::sqrt(2 * degrees) + 4;
}

/// Other starts are gone on from where the best one does not end in a likely medium. Goes on where
/// the model turns out to need more ordinates.
LeastSquaresFit refined_fit(const FitTask& task, const LeastSquares& problem, SlabModel& model,
                            const Data& data, MediumFit& fit) {
  constexpr double share = 0.05, tolerance = 1e-3;
  fit.numerical = model.refine(scenes_at(task, middle(task)), data.errors(), share);
  auto starts = best_starts(problem, grid_of_starts(task, problem), 3);
  LeastSquaresFit best =
      levenberg_marquardt(problem, starts.front(), task.most_iterations, tolerance);
  if (!(best.converged && is_likely(best)))
    best = best_fit(problem, starts, task.most_iterations, tolerance);
  const int before = model.order();
  fit.numerical = model.refine(scenes_at(task, best.parameters), data.errors(), share);
  if (model.order() == before) return best;
  auto trace = std::move(best.trace);
  best = levenberg_marquardt(problem, best.parameters, task.most_iterations, tolerance);
  trace.insert(trace.end(), best.trace.begin(), best.trace.end());
  best.trace = std::move(trace);
  return best;
}

}  // namespace

void check(const FitTask& task) {
  const Data data(task);
  const std::size_t free = task.free.size();
  if (static_cast<Index>(free) > data.values().size())
    throw InputError("free", free,
                     "parameters from " + std::to_string(data.values().size()) +
                         " values: must not be more than these");
  SlabModel(curves_of(task), scenes_at(task, middle(task)));
}

MediumFit fit_medium(const FitTask& task) {
  const Data data(task);
  SlabModel model(curves_of(task), scenes_at(task, middle(task)));
  const LeastSquares problem = problem_of(task, model, data);
  MediumFit fit;
  const LeastSquaresFit best = refined_fit(task, problem, model, data, fit);
  put_information(task, problem, best, fit);
  fit.model = model.values(scenes_at(task, best.parameters));
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
