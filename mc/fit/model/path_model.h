#pragma once

#include <optional>
#include <vector>

#include <Eigen/Core>

#include "core/run/runner.h"
#include "mc/fit/model/slab_model.h"
#include "mc/fit/task/fit_task.h"
#include "mc/jobs/path_job.h"
#include "mc/paths/dynamics/moving_derivatives.h"

namespace flatspeckle::mc {

/// Monte Carlo estimates of all measured values for one medium.
struct SampledModel {
  Eigen::VectorXd values;
  /// Derivatives of the values by the coordinates of the parameters, [value][parameter].
  Eigen::MatrixXd derivatives;
  /// Jackknife deviations, one matrix per run: deviations() of the values, then of each column of
  /// `derivatives`, [value or derivative][group]. The product of one matrix with its transpose is
  /// the covariance of the sampling errors of that run. Runs are independent of each other.
  std::vector<Eigen::MatrixXd> deviations;

  /// Returns the covariance of the sampling errors of the values.
  Eigen::MatrixXd noise() const;
  /// Returns the expected increase of the matrix J^T weight J by sampling noise in the derivatives
  /// J.
  Eigen::MatrixXd added_information(const Eigen::MatrixXd& weight) const;
};

/// Estimates the measured curves by Monte Carlo, with derivatives from the same paths. Reflected
/// and transmitted power is computed by transport for slabs and by separate random walks for boxes.
/// A correction is included if all placements have the same number of scatterers. All media use the
/// same random numbers.
class PathModel {
 public:
  /// Throws InputError for measurements that the Monte Carlo model does not support.
  explicit PathModel(const FitTask& task);

  /// Selects the medium at these coordinates and discards all earlier samples. Throws InputError.
  void move(const Eigen::VectorXd& coordinates);
  /// Samples the selected medium until each run has this number of paths.
  void sample(double paths);
  SampledModel model() const;

 private:
  /// Correction of covariances for a fixed number of scatterers, estimated from separate paths.
  struct FixedCount {
    PathJob job;
    RunState state;
    double count = 0;  ///< mean number of scatterers

    /// Returns the correction of each entry.
    std::vector<Complex> correction(double samples, std::span<const Complex> sums) const;
  };

  /// Curves that are estimated from the same paths.
  struct Run {
    bool power, reversed;
    std::vector<double> delays;
    std::vector<std::size_t> curves;
    std::vector<CovarianceRequest> requests;  ///< request of each curve
    PathJob job{};
    RunState state{};
    std::optional<FixedCount> fixed_count{};
    Lights lights{};  ///< illuminations of all curves, if `power`
    double beta = 1;
    std::vector<double> beta_derivatives{};  ///< derivatives of beta by the coordinates

    /// Number of covariances of all curves: the entries at time 0 and after each delay.
    std::size_t covariances() const { return job.entries * (1 + delays.size()); }
  };

  bool can_share(const Run& run, const Media& media, std::size_t curve) const;
  void begin(Run& run, std::uint64_t seed, const Media& media) const;
  std::vector<MovingDerivative> derivatives(Run& run, const Scene& scene) const;
  std::vector<Complex> power_values(const Run& run, std::span<const Complex> shares) const;
  std::vector<Complex> curve_values(const Run& run, double beta,
                                    std::span<const Complex> covariances) const;
  std::vector<Complex> run_values(const Run& run, std::vector<Complex> all,
                                  std::span<const Complex> correction) const;
  void add(const Run& run, SampledModel& model, Eigen::VectorXd& all) const;
  void put_power(SampledModel& model) const;

  const FitTask& task_;
  std::vector<Curve> curves_;
  std::vector<Eigen::Index> first_;  ///< index of each curve's first value among all values
  Eigen::Index size_ = 0;
  std::vector<Run> runs_;
  /// Indices of the curves of power reflected or transmitted by slabs.
  std::vector<std::size_t> power_;
  Eigen::VectorXd at_;
};

}  // namespace flatspeckle::mc
