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

/// Returns a least-squares problem that contains only the bounds of the parameters, as coordinates.
BoundedLeastSquares bounds_of(const std::vector<FreeParameter>& free);

/// Returns the starting coordinates of the parameters. A parameter without a start begins at the
/// middle of its bounds.
Eigen::VectorXd middle(const FitTask& task);
/// Returns all combinations of the parameters' starts.
std::vector<Eigen::VectorXd> grid_of_starts(const FitTask& task);

/// The values of all measurements, concatenated, and the transformation that makes their errors
/// independent.
class FitData {
 public:
  /// Throws InputError if the covariance of a measurement is not positive definite.
  explicit FitData(const FitTask& task);

  bool has_fields() const { return has_fields_; }
  /// Returns the data with the errors that measured fields have if the model is correct. Fields of
  /// unknown scale are rescaled to the scale of the model. model: values of all curves.
  FitData about(const Eigen::VectorXd& model) const;

  const Eigen::VectorXd& values() const { return values_; }
  const Eigen::VectorXd& errors() const { return errors_; }
  Eigen::VectorXd residuals(const Eigen::VectorXd& model) const {
    return whitened(model - values_);
  }
  /// Multiplies each column by L^-1, where L L^T is covariance().
  Eigen::MatrixXd whitened(const Eigen::MatrixXd& of) const;
  /// Returns the covariance of all values.
  Eigen::MatrixXd covariance() const;
  /// Returns the covariance of all values before shrinkage. It describes the scatter of the values;
  /// the shrunk covariance() determines their weights.
  Eigen::MatrixXd scatter() const;

 private:
  const std::vector<Measurement>* measurements_;
  bool has_fields_ = false;
  Eigen::VectorXd values_, errors_;
  std::vector<Eigen::LLT<Eigen::MatrixXd>> roots_;
};

}  // namespace flatspeckle::mc
