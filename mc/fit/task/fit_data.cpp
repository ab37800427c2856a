#include "mc/fit/task/fit_data.h"

#include "core/error.h"

namespace flatspeckle::mc {

namespace {

using Eigen::Index;
using Eigen::MatrixXcd;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// Whether the model's values are proportional to the parameter, so that any start leads to the
/// same search.
bool is_factor(const FreeParameter& one) {
  return one.key == "detector_scale" || one.key == "beta";
}

}  // namespace

std::vector<Curve> curves_of(const FitTask& task) {
  std::vector<Curve> curves;
  for (const Measurement& one : task.measurements)
    curves.insert(curves.end(), one.curves.begin(), one.curves.end());
  return curves;
}

Media media_at(const FitTask& task, const VectorXd& coordinates) {
  Media media;
  for (const Measurement& one : task.measurements)
    for (const Curve& curve : one.curves)
      media.emplace_back(with_parameters(curve.scene, task.free, coordinates));
  return media;
}

BoundedLeastSquares bounds_of(const std::vector<FreeParameter>& free) {
  return {{}, {}, lower_coordinates(free), upper_coordinates(free)};
}

VectorXd middle(const FitTask& task) {
  VectorXd at = (lower_coordinates(task.free) + upper_coordinates(task.free)) / 2;
  for (std::size_t i = 0; i < task.free.size(); ++i)
    if (const auto& start = task.free[i].start)
      at[static_cast<Index>(i)] = task.free[i].coordinate(*start);
  return at;
}

std::vector<VectorXd> grid_of_starts(const FitTask& task) {
  const VectorXd lower = lower_coordinates(task.free), upper = upper_coordinates(task.free);
  std::vector<VectorXd> starts{middle(task)};
  for (std::size_t i = 0; i < task.free.size(); ++i) {
    if (task.free[i].start || is_factor(task.free[i])) continue;
    const auto j = static_cast<Index>(i);
    std::vector<VectorXd> more;
    for (const VectorXd& start : starts)
      for (int n = 0; n < task.starts; ++n) {
        more.push_back(start);
        more.back()[j] = lower[j] + (n + 0.5) / task.starts * (upper[j] - lower[j]);
      }
    starts = std::move(more);
  }
  return starts;
}

FitData::FitData(const FitTask& task) : measurements_(&task.measurements) {
  Index size = 0;
  for (const Measurement& one : task.measurements) size += one.values.size();
  values_.resize(size);
  errors_.resize(size);
  Index first = 0;
  for (const Measurement& one : task.measurements) {
    values_.segment(first, one.values.size()) = one.values;
    errors_.segment(first, one.values.size()) = one.covariance.diagonal().cwiseSqrt();
    has_fields_ = has_fields_ || !one.samples.empty();
    roots_.emplace_back(one.covariance);
    if (roots_.back().info() != Eigen::Success)
      throw InputError("measurement", one.name,
                       "the covariance of its errors must be positive definite");
    first += one.values.size();
  }
}

FitData FitData::about(const VectorXd& model) const {
  FitData found = *this;
  Index first = 0;
  for (std::size_t m = 0; m < roots_.size(); ++m) {
    const Measurement& one = (*measurements_)[m];
    MatrixXd covariance = one.covariance;
    Index inside = 0;
    for (const FieldSample& sample : one.samples) {
      const auto size = static_cast<Index>(sample.channels * sample.channels);
      const MatrixXcd c = unpacked(model.segment(first + inside, size), sample.channels),
                      s = unpacked(one.values.segment(inside, size), sample.channels);
      covariance.block(inside, inside, size, size) = sample_errors(sample, c);
      const double scale = sample.known_scale ? 1 : likeliest_scale(c, s);
      found.values_.segment(first + inside, size) = one.values.segment(inside, size) / scale;
      inside += size;
    }
    if (!one.samples.empty()) {
      found.roots_[m].compute(covariance);
      found.errors_.segment(first, inside) = covariance.diagonal().cwiseSqrt();
    }
    first += one.values.size();
  }
  return found;
}

MatrixXd FitData::whitened(const MatrixXd& of) const {
  MatrixXd white(of.rows(), of.cols());
  Index first = 0;
  for (const auto& root : roots_) {
    white.middleRows(first, root.rows()) = root.matrixL().solve(of.middleRows(first, root.rows()));
    first += root.rows();
  }
  return white;
}

MatrixXd FitData::scatter() const {
  MatrixXd all = covariance();
  Index first = 0;
  for (const Measurement& one : *measurements_) {
    const Index size = one.values.size();
    auto block = all.block(first, first, size, size);
    const VectorXd variance = block.diagonal();
    block.diagonal() -= one.shrinkage * variance;
    block /= 1 - one.shrinkage;
    first += size;
  }
  return all;
}

MatrixXd FitData::covariance() const {
  MatrixXd all = MatrixXd::Zero(values_.size(), values_.size());
  Index first = 0;
  for (const auto& root : roots_) {
    all.block(first, first, root.rows(), root.rows()) = root.reconstructedMatrix();
    first += root.rows();
  }
  return all;
}

}  // namespace flatspeckle::mc
