#pragma once

#include <optional>
#include <vector>

#include <Eigen/Core>

#include "core/run/runner.h"
#include "mc/fit/model/slab_model.h"
#include "mc/fit/task/fit_task.h"
#include "mc/jobs/path_job.h"
#include "mc/paths/dynamics/moving_slopes.h"

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
/// transport, that of boxes by walks of its own. Where placements hold a fixed number of
/// scatterers, that is taken in. Media next to each other see the same random numbers.
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
  /// What a fixed number of scatterers changes, by paths of its own.
  struct FixedCount {
    PathJob job;
    RunState state;
    double count = 0;

    /// Of each entry.
    std::vector<Complex> correction(double samples, std::span<const Complex> sums) const;
  };

  /// Curves that the same paths tell.
  struct Run {
    bool power, reversed;
    std::vector<double> delays;
    std::vector<std::size_t> curves;
    std::vector<CovarianceRequest> requests;  ///< of each
    PathJob job{};
    RunState state{};
    std::optional<FixedCount> fixed_count{};
    Lights lights{};  ///< of all curves, of power
    double beta = 1;
    std::vector<double> beta_slopes{};  ///< by the coordinates

    /// Covariances of all curves, [0 and delays][entry].
    std::size_t covariances() const { return job.entries * (1 + delays.size()); }
  };

  bool joins(const Run& run, const Media& media, std::size_t curve) const;
  void begin(Run& run, std::uint64_t seed, const Media& media) const;
  std::vector<MovingSlope> slopes(Run& run, const Scene& scene) const;
  std::vector<Complex> power_values(const Run& run, std::span<const Complex> shares) const;
  std::vector<Complex> curve_values(const Run& run, double beta,
                                    std::span<const Complex> covariances) const;
  std::vector<Complex> run_values(const Run& run, std::vector<Complex> all,
                                  std::span<const Complex> correction) const;
  void add(const Run& run, SampledModel& model, Eigen::VectorXd& all) const;
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
