#pragma once

#include <vector>

#include <Eigen/Cholesky>
#include <Eigen/Core>

#include "mc/fit/medium_fit.h"

namespace flatspeckle::mc {

std::vector<Curve> curves_of(const FitTask& task);
/// Of every curve.
std::vector<Scene> scenes_at(const FitTask& task, const Eigen::VectorXd& coordinates);

/// Where parameters start, or amid their bounds.
Eigen::VectorXd middle(const FitTask& task);
/// All combinations of the parameters' starts.
std::vector<Eigen::VectorXd> grid_of_starts(const FitTask& task);

/// All measurements as one, their errors made independent.
class Data {
 public:
  /// Throws InputError where a covariance is not positive definite.
  explicit Data(const FitTask& task);

  const Eigen::VectorXd& values() const { return values_; }
  const Eigen::VectorXd& errors() const { return errors_; }
  Eigen::VectorXd residuals(const Eigen::VectorXd& model) const {
    return whitened(model - values_);
  }
  /// Of each column: L^-1, where L L^T is the covariance.
  Eigen::MatrixXd whitened(const Eigen::MatrixXd& of) const;
  /// Of all values.
  Eigen::MatrixXd covariance() const;

 private:
  Eigen::VectorXd values_, errors_;
  std::vector<Eigen::LLT<Eigen::MatrixXd>> roots_;
};

}  // namespace flatspeckle::mc
