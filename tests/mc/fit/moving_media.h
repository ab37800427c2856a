#pragma once

#include <random>
#include <string>

#include "bench/scenes/synthetic_slab.h"
#include "core/run/runner.h"
#include "mc/paths/dynamics/moving_derivatives.h"
#include "mc/paths/estimators/gradient.h"

namespace flatspeckle::bench {

/// Slab measured by |g1| after delays: reflected light constrains the diffusion of the scatterers,
/// transmitted light the optical depth.
inline SyntheticSlab diffusing_slab() {
  SyntheticSlab slab(200, 0.6, 1, 8);
  slab.add_decay(std::numbers::pi - 0.5, {0.002, 0.006, 0.02, 0.06, 0.2});
  slab.add_decay(0.2, {0.001, 0.002, 0.005, 0.01, 0.02});
  return slab;
}

/// Squared speckle contrast K^2 of the light that this slab reflects, after exposures.
inline SyntheticSlab exposed_slab() {
  SyntheticSlab slab(200, 0.6, 1, 8);
  slab.add_contrast(std::numbers::pi - 0.5, {0.01, 0.05, 0.2, 1});
  return slab;
}

inline mc::FitTask motion_task(std::vector<mc::Measurement> measurements,
                               const std::vector<std::string>& free) {
  return slab_task(std::move(measurements), free, [](mc::MovingSpec& scene) {
    scene.albedo = 1;
    scene.g = 0.6;
  });
}

/// |g1| of a slab whose scatterers diffuse and are sheared, computed by its own paths; noise is
/// added as in SyntheticSlab. 3 % noise determines the shear to 4 %. Nearer to 0, where decays
/// depend on the square of the shear alone, errors are not linear.
class ShearedSlab {
 public:
  static constexpr double diffusion = 0.5, shear = 0.06;

  explicit ShearedSlab(std::uint64_t paths = 200000) {
    curve_.scene.domain = "slab";
    curve_.scene.depth = 50;
    curve_.scene.scatterer = "hg";
    curve_.scene.g = 0.6;
    curve_.scene.optical_depth = 5;
    curve_.scene.view_angles = {0.2, 0.9, std::numbers::pi - 0.5};
    curve_.times = curve_.delays = {0.005, 0.01, 0.02, 0.05, 0.1, 0.2};
    const Scene scene = make_scene(curve_.scene);
    for (std::size_t i = 0; i < curve_.times.size() * scene.request.entries.size(); ++i) {
      curve_.entries.push_back(i);
      curve_.abscissa.push_back(curve_.times[i / scene.request.entries.size()]);
    }
    mc::Plan plan = mc::gradient_plan(scene, mc::ReversedPaths::no);
    plan.sampled_single = true;
    const mc::PathJob job =
        mc::moving_derivative_job(scene, plan, curve_.delays, {diffusion, {}, shear}, {}, 12345);
    RunOptions options;
    options.stop.samples = paths;
    RunState state;
    run_batches(job.field.batches, options, state);
    exact_ = mc::observed(curve_, 1, scene.request,
                          job.all(state.sums.total_samples(), state.sums.total()));
  }

  /// Returns a fit of measurements with noise from a seed; `share` is its size relative to each
  /// value.
  mc::FitTask task(unsigned seed, double share) const {
    std::mt19937_64 random(seed);
    std::normal_distribution<double> normal;
    mc::Measurement one{"synthetic", {curve_}, {}, {}};
    one.values = Eigen::Map<const Eigen::VectorXd>(exact_.data(), std::ssize(exact_));
    const Eigen::VectorXd error = share * one.values;
    one.covariance = error.cwiseAbs2().asDiagonal();
    for (Eigen::Index i = 0; i < error.size(); ++i) one.values[i] += error[i] * normal(random);
    mc::FitTask task;
    task.free = mc::read_free_parameters({"diffusion=0.05:5", "shear=0:0.3"}, curve_.scene);
    task.measurements = {one};
    task.paths.emplace().seed = seed;
    return task;
  }

 private:
  mc::Curve curve_;
  std::vector<double> exact_;
};

}  // namespace flatspeckle::bench
