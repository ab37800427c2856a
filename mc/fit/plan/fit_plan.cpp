#include "mc/fit/plan/fit_plan.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <Eigen/LU>

#include "core/algebra/dense.h"
#include "core/error.h"
#include "core/result/result_group.h"
#include "core/search/levenberg_marquardt.h"
#include "mc/fit/task/fit_data.h"
#include "mc/slab/slab_covariance.h"

namespace flatspeckle::mc {

const DatasetTable plan_table{
    .name = "fit plan",
    .rows =
        {{"parameter", Data::numbers, "", "1", "number of the free key"},
         {"parameter_2", Data::numbers, "", "1", "number of the second free key"},
         {"parameter_name", Data::text, "parameter", "", "name of the free key"},
         {"planned", Data::estimate, "parameter", "",
          "value of the free key, with the smallest possible error"},
         {"parameter_correlation", Data::real, "parameter parameter_2", "1",
          "correlation of the estimates' errors"},
         {"patterns_to_percent", Data::real, "parameter", "1",
          "number of patterns that reduces the error to a hundredth of the value"},
         {"view_angle", Data::scale, "", "rad", "direction of view, from +z towards +x"},
         {"tilt", Data::scale, "", "rad", "rotation of the illumination"},
         {"growth_without_view", Data::real, "view_angle parameter", "1",
          "error without this view, divided by the error with all views"},
         {"growth_without_tilt", Data::real, "tilt parameter", "1",
          "error without this tilt, divided by the error with all tilts"},
         {"growth_by_choice", Data::real, "parameter", "1",
          "error with the chosen views and tilts, divided by the error with all that were given"},
         {"point", Data::numbers, "", "1", "number of the point"},
         {"point_name", Data::text, "point", "", "values that are varied at this point"},
         {"point_planned", Data::estimate, "point parameter", "",
          "value at this point, with the smallest possible error"},
         {"point_patterns_to_percent", Data::real, "point parameter", "1",
          "number of patterns that reduces the error at this point to a hundredth of the value"}},
    .attributes = {
        {"", "patterns", "float64", "number of independent patterns of each view"},
        {"", "condition", "float64",
         "ratio of the largest to the least eigenvalue of the information, with parameters "
         "in units of the distance between their bounds; absent if a combination is not "
         "determined at all"}}};

void write_plan(ResultFile& file, const PlanTask& task, const FitPlan& plan) {
  const ResultGroup root(file, plan_table);
  root.number("parameter", task.free.size());
  root.number("parameter_2", task.free.size());
  root.put("parameter_name", column(task.free, &FreeParameter::key));
  root.put("planned", row_major(plan.values), row_major(plan.errors));
  root.put("parameter_correlation", row_major(plan.correlation));
  root.put("patterns_to_percent", row_major(plan.patterns_to_percent));
  root.put("view_angle", plan.views);
  root.put("tilt", plan.tilts);
  if (task.most_views + task.most_tilts > 0)
    root.put("growth_by_choice", row_major(plan.growth_by_choice));
  root.put("growth_without_view", row_major(plan.without_view));
  root.put("growth_without_tilt", row_major(plan.without_tilt));
  root.attribute("patterns", task.patterns);
  if (std::isfinite(plan.condition)) root.attribute("condition", plan.condition);
}

void write_plans(ResultFile& file, const PlanTask& task, const std::vector<PlanPoint>& points) {
  const ResultGroup root(file, plan_table);
  std::vector<double> values, errors, patterns;
  const auto append = [](std::vector<double>& all, const Eigen::VectorXd& more) {
    all.insert(all.end(), more.begin(), more.end());
  };
  for (const PlanPoint& point : points) {
    append(values, point.plan.values);
    append(errors, point.plan.errors);
    append(patterns, point.plan.patterns_to_percent);
  }
  root.number("parameter", task.free.size());
  root.put("parameter_name", column(task.free, &FreeParameter::key));
  root.number("point", points.size());
  root.put("point_name", column(points, &PlanPoint::name));
  root.put("point_planned", values, errors);
  root.put("point_patterns_to_percent", patterns);
  root.attribute("patterns", task.patterns);
}

namespace {

using Eigen::Index;
using Eigen::MatrixXcd;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// Covariance matrix of the fields in each view, and the resolution of the solution. The first
/// field belongs to the illumination without tilt, the others to the tilted illuminations.
struct Covariances {
  std::vector<MatrixXcd> of_view;
  Resolution resolution;
};

Covariances covariances(Scene scene, const Refinement& refinement) {
  const CovarianceRequest tilts = scene.request;
  const std::size_t views = tilts.reference_views, fields = 1 + tilts.moves;
  CovarianceRequest& all = scene.request;
  all.kind = CovarianceRequest::Kind::pairs;
  all.entries.clear();
  const auto channel = [&](std::size_t view, std::size_t field) {
    const std::size_t entry =
        field == 0 ? tilts.reference_intensity(view) : tilts.tilted_intensity(field - 1, view);
    return tilts.entries[entry].a;
  };
  for (std::size_t view = 0; view < views; ++view)
    for (std::size_t i = 0; i < fields; ++i)
      for (std::size_t j = 0; j <= i; ++j)
        all.entries.push_back({channel(view, i), channel(view, j)});
  const Refined solution = slab_covariance(scene, false, refinement);
  Covariances found{{}, solution.resolution};
  auto next = solution.value.begin();
  for (std::size_t view = 0; view < views; ++view) {
    MatrixXcd& c = found.of_view.emplace_back(fields, fields);
    for (Index i = 0; i < c.rows(); ++i)
      for (Index j = 0; j <= i; ++j, ++next) {
        c(i, j) = *next;
        c(j, i) = std::conj(*next);
      }
  }
  return found;
}

MatrixXcd without(const MatrixXcd& matrix, Index field) {
  const Index after = matrix.rows() - field - 1;
  MatrixXcd found(matrix.rows() - 1, matrix.cols() - 1);
  found << matrix.topLeftCorner(field, field), matrix.topRightCorner(field, after),
      matrix.bottomLeftCorner(after, field), matrix.bottomRightCorner(after, after);
  return found;
}

/// Covariances of the fields in each view, with derivatives by the coordinates of the parameters.
struct PlannedFields {
  std::vector<MatrixXcd> covariance;
  std::vector<std::vector<MatrixXcd>> derivatives;  ///< [view][parameter]

  PlannedFields without_view(std::size_t view) const {
    PlannedFields found = *this;
    found.covariance.erase(found.covariance.begin() + static_cast<std::ptrdiff_t>(view));
    found.derivatives.erase(found.derivatives.begin() + static_cast<std::ptrdiff_t>(view));
    return found;
  }
  PlannedFields without_tilt(std::size_t tilt) const {
    const auto field = static_cast<Index>(tilt) + 1;
    PlannedFields found = *this;
    for (MatrixXcd& of_view : found.covariance) of_view = without(of_view, field);
    for (auto& of_view : found.derivatives)
      for (MatrixXcd& derivative : of_view) derivative = without(derivative, field);
    return found;
  }

  /// Returns the Fisher information of all fields.
  MatrixXd information(Index parameters) const {
    MatrixXd total = MatrixXd::Zero(parameters, parameters);
    for (std::size_t v = 0; v < covariance.size(); ++v)
      total += field_information(covariance[v], derivatives[v]);
    return total;
  }
};

/// Computes the derivatives by differences of solutions with one resolution, so that these vary
/// smoothly.
PlannedFields fields_of(const PlanTask& task, const VectorXd& at) {
  constexpr double step = 1e-3;  // in units of the distance between the bounds
  constexpr double tolerance = 1e-4;
  const std::size_t count = 1 + 2 * task.free.size();
  std::size_t done = 0;
  const auto solved = [&](const VectorXd& x, const Refinement& refinement) {
    auto found = covariances(scene_of(with_parameters(task.scene, task.free, x)), refinement);
    if (task.solved) task.solved(++done, count);
    return found;
  };
  const Covariances here = solved(at, {.tolerance = tolerance});
  const Refinement same{.tolerance = tolerance, .fixed = here.resolution};
  const VectorXd lower = lower_coordinates(task.free), upper = upper_coordinates(task.free);
  PlannedFields found{here.of_view, {}};
  found.derivatives.resize(found.covariance.size());
  for (Index i = 0; i < at.size(); ++i) {
    VectorXd high = at, low = at;
    high[i] = std::min(at[i] + step * (upper[i] - lower[i]), upper[i]);
    low[i] = std::max(at[i] - step * (upper[i] - lower[i]), lower[i]);
    const auto above = solved(high, same).of_view, below = solved(low, same).of_view;
    for (std::size_t v = 0; v < above.size(); ++v)
      found.derivatives[v].push_back((above[v] - below[v]) / (high[i] - low[i]));
  }
  return found;
}

/// A plan whose views and tilts can be left out.
class Planned {
 public:
  explicit Planned(const PlanTask& task)
      : task_(task),
        views_{task.scene.view_angles, &PlannedFields::without_view, task.most_views},
        tilts_{task.scene.tilts, &PlannedFields::without_tilt, task.most_tilts},
        at_(std::ssize(task.free)),
        bounds_(bounds_of(task.free)) {
    for (Index i = 0; i < at_.size(); ++i) {
      const FreeParameter& free = task.free[static_cast<std::size_t>(i)];
      at_[i] = free.coordinate(free.start.value());
    }
    fields_ = fields_of(task, at_);
  }

  const VectorXd& at() const { return at_; }
  const std::vector<double>& views() const { return views_.angles; }
  const std::vector<double>& tilts() const { return tilts_.angles; }

  Information known() const { return known(fields_); }

  MatrixXd growth_without_views() const { return growth(views_); }
  MatrixXd growth_without_tilts() const { return growth(tilts_); }

  /// Leaves out the views and tilts that are not chosen.
  void choose() {
    while (true) {
      Angles* of = nullptr;
      std::size_t omitted = 0;
      double least = std::numeric_limits<double>::infinity();
      for (Angles* all : {&views_, &tilts_})
        for (std::size_t i = 0;
             all->most > 0 && all->angles.size() > all->most && i < all->angles.size(); ++i)
          if (const double sum = squared_errors((fields_.*all->without)(i));
              of == nullptr || sum < least)
            of = all, omitted = i, least = sum;
      if (of == nullptr) return;
      fields_ = (fields_.*of->without)(omitted);
      of->angles.erase(of->angles.begin() + static_cast<std::ptrdiff_t>(omitted));
    }
  }

 private:
  struct Angles {
    std::vector<double> angles;
    /// Returns the fields without the view or tilt with this index.
    PlannedFields (PlannedFields::*without)(std::size_t) const;
    std::size_t most;  ///< number to choose; 0: all
  };

  Information known(const PlannedFields& fields) const {
    return information_of(bounds_, task_.patterns * fields.information(at_.size()));
  }

  /// Returns the sum of the squared relative errors of the parameters.
  double squared_errors(const PlannedFields& fields) const {
    const VectorXd errors = known(fields).errors();
    double sum = 0;
    for (Index i = 0; i < errors.size(); ++i) {
      const FreeParameter& free = task_.free[static_cast<std::size_t>(i)];
      sum += std::pow(errors[i] * free.derivative(at_[i]) / free.start.value(), 2);
    }
    return sum;
  }

  /// Returns the errors if one view or tilt is left out, divided by the errors with all fields,
  /// [left out][parameter].
  MatrixXd growth(const Angles& all) const {
    const VectorXd errors = known().errors();
    MatrixXd found(std::ssize(all.angles), at_.size());
    for (std::size_t i = 0; i < all.angles.size(); ++i)
      found.row(static_cast<Index>(i)) =
          known((fields_.*all.without)(i)).errors().cwiseQuotient(errors).transpose();
    return found;
  }

  const PlanTask& task_;
  Angles views_, tilts_;
  VectorXd at_;
  BoundedLeastSquares bounds_;
  PlannedFields fields_;
};

void check_finite(const PlanTask& task, const FitPlan& plan) {
  for (Index i = 0; i < plan.values.size(); ++i)
    if (!std::isfinite(plan.patterns_to_percent[i]))
      throw InputError(
          task.free[static_cast<std::size_t>(i)].key, plan.values[i],
          "has no finite relative error: its value must not be close to 0, and the tilts "
          "must differ from 0 and from each other");
}

}  // namespace

MatrixXd field_information(const MatrixXcd& covariance, const std::vector<MatrixXcd>& derivatives) {
  const Eigen::PartialPivLU<MatrixXcd> solver(covariance);
  const auto count = static_cast<Index>(derivatives.size());
  std::vector<MatrixXcd> relative;
  for (const MatrixXcd& derivative : derivatives) relative.push_back(solver.solve(derivative));
  MatrixXd found(count, count);
  VectorXd with_scale(count);  // the derivative of C by its scale factor is C
  for (Index a = 0; a < count; ++a) {
    with_scale[a] = relative[static_cast<std::size_t>(a)].trace().real();
    for (Index b = 0; b < count; ++b)
      found(a, b) = (relative[static_cast<std::size_t>(a)] * relative[static_cast<std::size_t>(b)])
                        .trace()
                        .real();
  }
  return found - with_scale * with_scale.transpose() / static_cast<double>(covariance.rows());
}

FitPlan fit_plan(const PlanTask& task) {
  Planned planned(task);
  FitPlan plan;
  const VectorXd with_all = planned.known().errors();
  planned.choose();
  const Information all = planned.known();
  plan.values.resize(planned.at().size());
  plan.errors = all.errors();
  plan.growth_by_choice = plan.errors.cwiseQuotient(with_all);
  for (Index i = 0; i < plan.values.size(); ++i) {
    const FreeParameter& free = task.free[static_cast<std::size_t>(i)];
    plan.values[i] = free.start.value();
    plan.errors[i] *= free.derivative(planned.at()[i]);
  }
  plan.correlation = all.correlation;
  plan.condition = all.condition;
  plan.patterns_to_percent =
      task.patterns * (100 * plan.errors.cwiseQuotient(plan.values)).cwiseAbs2();
  check_finite(task, plan);
  plan.views = planned.views();
  plan.tilts = planned.tilts();
  plan.without_view = planned.growth_without_views();
  plan.without_tilt = planned.growth_without_tilts();
  return plan;
}

}  // namespace flatspeckle::mc
