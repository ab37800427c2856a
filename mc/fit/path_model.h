#pragma once

#include <vector>

#include <Eigen/Core>

#include "core/run/runner.h"
#include "mc/estimators/medium_slope.h"
#include "mc/estimators/path_job.h"
#include "mc/fit/medium_fit.h"
#include "mc/fit/slab_model.h"

namespace flatspeckle::mc {

/// What paths tell of all values at one medium.
struct SampledModel {
  Eigen::VectorXd values;
  Eigen::MatrixXd slopes;  ///< by the coordinates, [value][parameter]
  /// Of each run, which is independent of the others: [values, then each column of slopes][group];
  /// products of them are the covariances of errors by chance.
  std::vector<Eigen::MatrixXd> deviations;

  /// Covariance of the values' errors by chance.
  Eigen::MatrixXd noise() const;
  /// What chance in the slopes adds to J^T weight J in the mean.
  Eigen::MatrixXd added_information(const Eigen::MatrixXd& weight) const;
};

/// Curves by Monte Carlo, with derivatives from the same paths; the power through slabs is by
/// transport. Media next to each other see the same random numbers.
class PathModel {
 public:
  /// Throws InputError for what paths cannot tell.
  explicit PathModel(const FitTask& task);

  /// Begins anew in the medium at these coordinates. Throws InputError.
  void move(const Eigen::VectorXd& coordinates);
  /// Goes on until each run has so many paths.
  void sample(double paths);
  SampledModel model() const;

 private:
  /// Curves that the same paths tell.
  struct Run {
    bool reversed;
    std::vector<std::size_t> curves;
    std::vector<CovarianceRequest> requests;  ///< of each
    PathJob job;
    RunState state;
  };

  bool joins(const Run& run, const std::vector<Scene>& scenes, std::size_t curve) const;
  void begin(Run& run, std::uint64_t seed, const std::vector<Scene>& scenes) const;
  std::vector<MediumSlope> slopes(const Scene& scene, std::size_t curve) const;
  std::vector<Complex> curve_values(const Run& run, std::span<const Complex> entries) const;
  std::vector<Complex> run_values(const Run& run, double samples,
                                  std::span<const Complex> sums) const;
  void put_power(SampledModel& model) const;

  const FitTask& task_;
  std::vector<Curve> curves_;
  std::vector<Eigen::Index> first_;  ///< of each curve in all values
  Eigen::Index size_ = 0;
  std::vector<Run> runs_;
  std::vector<std::size_t> power_;  ///< curves of it
  Eigen::VectorXd at_;
};

}  // namespace flatspeckle::mc
