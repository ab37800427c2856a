#pragma once

#include <vector>

#include <Eigen/Cholesky>
#include <Eigen/Core>

#include "core/search/levenberg_marquardt.h"
#include "mc/fit/task/curve_values.h"
#include "mc/fit/task/fit_task.h"

namespace flatspeckle::mc {

std::vector<Curve> curves_of(const FitTask& task);
Media media_at(const FitTask& task, const Eigen::VectorXd& coordinates);

/// The bounds of the parameters, as coordinates, of a problem without residuals.
BoundedLeastSquares bounds_of(const std::vector<FreeParameter>& free);

/// Where parameters start, or amid their bounds.
Eigen::VectorXd middle(const FitTask& task);
/// All combinations of the parameters' starts.
std::vector<Eigen::VectorXd> grid_of_starts(const FitTask& task);

/// All measurements as one, their errors made independent.
class FitData {
 public:
  /// Throws InputError where a covariance is not positive definite.
  explicit FitData(const FitTask& task);

  bool has_fields() const { return has_fields_; }
  /// With the errors that fields have where the model is right; of a scale that is not known,
  /// fields in that of the model.
  FitData about(const Eigen::VectorXd& model) const;

  const Eigen::VectorXd& values() const { return values_; }
  const Eigen::VectorXd& errors() const { return errors_; }
  Eigen::VectorXd residuals(const Eigen::VectorXd& model) const {
    return whitened(model - values_);
  }
  /// Of each column: L^-1, where L L^T is the covariance.
  Eigen::MatrixXd whitened(const Eigen::MatrixXd& of) const;
  /// Of all values.
  Eigen::MatrixXd covariance() const;
  /// The same before it was shrunk: how the values scatter, in place of how they weigh.
  Eigen::MatrixXd scatter() const;

 private:
  const std::vector<Measurement>* measurements_;
  bool has_fields_ = false;
  Eigen::VectorXd values_, errors_;
  std::vector<Eigen::LLT<Eigen::MatrixXd>> roots_;
};

}  // namespace flatspeckle::mc
