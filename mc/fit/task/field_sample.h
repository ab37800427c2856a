#pragma once

#include <span>
#include <vector>

#include <Eigen/Core>

#include "core/numbers/complex.h"

namespace flatspeckle::mc {

/// Fields of circular Gaussian statistics in independent patterns, of so many channels that are
/// correlated. The likelihood of a covariance C depends on their sample covariance S alone,
///   log L = -N [log det C + tr(C^-1 S)],
/// whose errors are Wishart's: Cov(S_ij, S_kl) = C_il C_kj / N. Least squares of S with these
/// errors of the best C is where the likelihood is largest.
struct FieldSample {
  std::size_t channels = 0;
  double patterns = 0;
  bool known_scale = true;  ///< else C holds up to a factor
};

/// A Hermitian matrix as so many real numbers as it has entries: row by row of its lower triangle
/// real parts and, off the diagonal, imaginary ones.
Eigen::VectorXd packed(const Eigen::MatrixXcd& matrix);
Eigen::MatrixXcd unpacked(const Eigen::VectorXd& values, std::size_t channels);
/// The same of the entries of its lower triangle.
std::vector<double> packed(std::span<const Complex> lower_triangle);

/// Covariance of the errors of a packed S about C; where the scale is not known, an error along C
/// that leaves it free.
Eigen::MatrixXd sample_errors(const FieldSample& sample, const Eigen::MatrixXcd& c);

/// The factor s of s C that S is likeliest of: tr(C^-1 S) / channels.
double likeliest_scale(const Eigen::MatrixXcd& c, const Eigen::MatrixXcd& s);

/// Of fields [pattern][channel], which have no mean.
Eigen::MatrixXcd sample_covariance(std::span<const Complex> fields, std::size_t channels);

}  // namespace flatspeckle::mc
