#pragma once

#include <span>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "core/numbers/complex.h"
#include "core/numbers/statistics.h"
#include "mc/fit/task/free_parameter.h"

namespace flatspeckle::mc {

/// Of what an estimator makes of sums, real parts, [value][group]: the product with its transpose
/// is the covariance of the errors, by leaving one group out at a time as jackknife() does.
Eigen::MatrixXd deviations(const GroupedSums& sums, const Estimator& theta);

/// The covariance of the errors of what an estimator makes of sums, real parts, by leaving one
/// group out at a time as jackknife() does; its inverse is that of Hartlap, Simon and Schneider
/// 2007 (eq. 17), for so many groups and values. Shrunk towards its diagonal (Ledoit and Wolf 2004)
/// by shrinkage_of(sums): sums of values whose errors all but cancel rest on a few strong paths,
/// and on the rounding of models. Empty where groups are fewer than values and ten.
Eigen::MatrixXd correlated_errors(const GroupedSums& sums, const Estimator& theta);
/// The share of the diagonal in it: 1/groups.
double shrinkage_of(const GroupedSums& sums);

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

/// What is measured: C_E or C_I of each move, summed over the views (C19), or |g1| and |g1|^2 after
/// each delay; variances of the field, [light][view]; shares of the power of each light; K^2 after
/// each exposure; covariances of fields, the lower triangle of one matrix, packed (FieldSample).
enum class Observable {
  field_correlation,
  intensity_correlation,
  intensity,
  reflectance,
  transmittance,
  squared_contrast,
  field_covariance
};
/// By their names in files.
inline const std::vector<std::string> observable_words = {
    "field_correlation", "intensity_correlation", "intensity",       "reflectance",
    "transmittance",     "squared_contrast",      "field_covariance"};

/// Values of one observable.
struct Curve {
  MovingSpec scene;  ///< all of it: what is free has its start or none
  Observable observable = Observable::field_correlation;
  std::vector<std::size_t> entries;  ///< of all that the scene has, those that were measured
  std::vector<double> abscissa;      ///< of each of them: tilt, view or light, radians, or time
  std::vector<double> times{};       ///< delays or exposures; entries then are [time][light][view]
  std::vector<double> delays{};      ///< after which the fields have to be known for that
  bool flows = true;                 ///< after delays magnitudes are measured, not real parts
  bool fixed_count = false;          ///< the number of scatterers was the same in all placements

  bool moving() const { return !delays.empty(); }
};

/// Curves whose errors are known together.
struct Measurement {
  std::string name;  ///< the file
  std::vector<Curve> curves;
  Eigen::VectorXd values;              ///< of all curves, one after the other
  Eigen::MatrixXd covariance;          ///< of their errors
  double shrinkage = 0;                ///< of that covariance towards its diagonal
  bool guessed_independent = false;    ///< the file does not tell how its errors are correlated
  std::vector<FieldSample> samples{};  ///< of fields: each curve is the covariance of one
  bool by_paths = false;               ///< made by Monte Carlo, which neglects what the model does
};

}  // namespace flatspeckle::mc
