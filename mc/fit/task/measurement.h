#pragma once

#include <span>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "core/numbers/complex.h"
#include "core/numbers/statistics.h"
#include "mc/distance/distance_job.h"
#include "mc/fit/task/free_parameter.h"

namespace flatspeckle::mc {

/// Returns the jackknife deviations of the real parts of an estimator, [value][group]. The product
/// of this matrix with its transpose is the covariance of the errors. As in jackknife(), one group
/// of the sums is left out at a time.
Eigen::MatrixXd deviations(const GroupedSums& sums, const Estimator& theta);

/// Returns the covariance of the errors of the real parts of an estimator, from deviations(). It is
/// scaled so that its inverse is unbiased for this number of groups and values (Hartlap, Simon and
/// Schneider [hartlap2007], eq. 17). It is also shrunk towards its diagonal [ledoit2004] by
/// shrinkage_of(sums), because combinations of values whose errors nearly cancel are dominated by a
/// few high-weight paths and by rounding errors of the models. Empty if there are fewer groups than
/// values plus ten.
Eigen::MatrixXd correlated_errors(const GroupedSums& sums, const Estimator& theta);
/// Weight of the diagonal in the shrunk covariance: 1/groups.
double shrinkage_of(const GroupedSums& sums);

/// Correlated fields of several channels, with circular Gaussian statistics, measured in N
/// independent patterns. The likelihood of a covariance C depends only on their sample covariance
/// S:
///   log L = -N [log det C + tr(C^-1 S)],
/// The errors of S follow the Wishart distribution: Cov(S_ij, S_kl) = C_il C_kj / N. A
/// least-squares fit of S with these errors, evaluated at the best C, maximises the likelihood.
struct FieldSample {
  std::size_t channels = 0;
  double patterns = 0;
  bool known_scale = true;  ///< false: C is known only up to a factor
};

/// Packs a Hermitian matrix into as many real numbers as it has entries. For each entry of the
/// lower triangle, row by row, these are the real part and, off the diagonal, the imaginary part.
Eigen::VectorXd packed(const Eigen::MatrixXcd& matrix);
Eigen::MatrixXcd unpacked(const Eigen::VectorXd& values, std::size_t channels);
/// Packs a matrix given by the entries of its lower triangle.
std::vector<double> packed(std::span<const Complex> lower_triangle);

/// Returns the covariance of the errors of a packed sample covariance if the true covariance is c.
/// If the scale is not known, a large error proportional to c is included, which leaves the scale
/// free.
Eigen::MatrixXd sample_errors(const FieldSample& sample, const Eigen::MatrixXcd& c);

/// Returns the factor f of maximum likelihood if the sample covariance s has the expectation f c:
/// tr(c^-1 s) / channels.
double likeliest_scale(const Eigen::MatrixXcd& c, const Eigen::MatrixXcd& s);

/// Returns the sample covariance of fields of zero mean, [pattern][channel].
Eigen::MatrixXcd sample_covariance(std::span<const Complex> fields, std::size_t channels);

/// A measured quantity.
enum class Observable {
  field_correlation,  ///< C_E of each tilt or shift, over all views (C19), or |g1| of each delay
  intensity_correlation,  ///< C_I of each tilt or shift, or |g1|^2 of each delay; at distances
                          ///< g2 - 1 = beta g1^2
  intensity,              ///< variance of the field, [light][view]
  reflectance,            ///< reflected fraction of the power of each illumination; at distances
                          ///< this fraction per area
  transmittance,          ///< transmitted fraction of the power of each illumination
  squared_contrast,       ///< K^2 of each exposure
  field_covariance        ///< covariances of fields: the lower triangle of a matrix, packed()
};
/// Names of the observables in files.
inline const std::vector<std::string> observable_words = {
    "field_correlation", "intensity_correlation", "intensity",       "reflectance",
    "transmittance",     "squared_contrast",      "field_covariance"};

/// Values of one observable.
struct Curve {
  MovingSpec scene;  ///< the complete scene; free keys have their start value or none
  Observable observable = Observable::field_correlation;
  /// Indices of the measured values among all values of the scene.
  std::vector<std::size_t> entries;
  std::vector<double> abscissa;  ///< for each entry: tilt, view or light angle in radians, or time
  std::vector<double> times{};   ///< delays or exposures; entries then are [time][light][view]
  std::vector<double> delays{};  ///< delays at which field correlations are required to compute the
                                 ///< values at `times`
  /// true: absolute values of the correlations at the delays were measured; false: real parts.
  bool flows = true;
  bool fixed_count = false;  ///< whether all placements have the same number of scatterers
  /// Set for values at distances from a beam: one detector for each value. `delays`, if any, are
  /// then also one for each value.
  std::optional<DistanceRequest> distances{};

  bool moving() const { return !delays.empty(); }
};

/// Curves with a joint covariance of their errors.
struct Measurement {
  std::string name;  ///< name of the file
  std::vector<Curve> curves;
  Eigen::VectorXd values;            ///< values of all curves, concatenated
  Eigen::MatrixXd covariance;        ///< covariance of the errors of `values`
  double shrinkage = 0;              ///< weight of the diagonal in the shrunk `covariance`
  bool guessed_independent = false;  ///< true: the file contains no correlations between its errors
  std::vector<FieldSample> samples{};  ///< for fields: one sample per curve
  /// Whether the values were simulated by Monte Carlo, which neglects the same effects as the
  /// model.
  bool by_paths = false;
};

}  // namespace flatspeckle::mc
