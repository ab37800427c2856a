#pragma once

#include <cmath>
#include <functional>
#include <numbers>
#include <random>
#include <vector>

#include "mc/fit/medium_fit.h"
#include "mc/fit/task/curve_values.h"
#include "mc/jobs/contrast.h"
#include "mc/jobs/flux_job.h"
#include "mc/slab/slab_covariance.h"
#include "mc/slab/slab_flux.h"
#include "mc/theory/memory_effect.h"

namespace flatspeckle::bench {

/// A slab with synthetic measurements. They are computed by deterministic transport to a relative
/// tolerance of 1e-6; noise has a standard deviation of 1 % of each value.
class SyntheticSlab {
 public:
  SyntheticSlab(double depth, double g, double albedo, double optical_depth)
      : depth_(depth), share_(0.01) {
    slab_.domain = "slab";
    slab_.depth = depth;
    slab_.scatterer = "hg";
    truth_ = slab_;
    truth_.g = g;
    truth_.albedo = albedo;
    truth_.optical_depth = optical_depth;
  }

  /// Adds C_E for a detection direction. Each tilt is given as the change of the transverse
  /// wavenumber times the depth.
  void add_curve(double view, const std::vector<double>& tilts) {
    mc::Curve curve{slab_, mc::Observable::field_correlation, {}, {}};
    curve.scene.covariance = "memory_effect";
    curve.scene.view_angles = {view};
    for (const double tilt : tilts)
      add(curve, std::asin(tilt / depth_ / (2 * std::numbers::pi)), curve.scene.tilts);
    const Scene scene = at_truth(curve.scene);
    const auto values =
        mc::field_correlation(scene.request, mc::slab_covariance(scene, false, {1e-6}).value);
    put(curve, real_parts(values));
  }

  static constexpr double beta = 0.5;

  /// Adds |g1| for a detection direction at delays given as k^2 D tau.
  void add_decay(double view, const std::vector<double>& delays) {
    mc::Curve curve{slab_, mc::Observable::field_correlation, {}, delays, delays, delays};
    put_moving(curve, view);
  }

  /// Adds the squared contrast K^2 for a detection direction and these exposure times. For static
  /// scatterers K^2 equals `beta`.
  void add_contrast(double view, const std::vector<double>& times) {
    mc::Curve curve{slab_, mc::Observable::squared_contrast, {}, times,
                    times, mc::exposure_delays(times)};
    put_moving(curve, view);
  }

  /// Changes the thickness of the medium for the measurements that follow.
  void set_depth(double depth) {
    slab_.depth = depth;
    truth_.optical_depth = *truth_.optical_depth * depth / depth_;
    depth_ = depth;
  }

  void add_transmittance() {
    mc::Curve curve{slab_, mc::Observable::transmittance, {0}, {0}};
    put(curve, {mc::slab_flux(at_truth(curve.scene), 1, {1e-6}).value[mc::transmitted].real()});
  }

  /// Returns the measurements with noise drawn with this seed.
  std::vector<mc::Measurement> measured(unsigned seed) const {
    std::mt19937_64 random(seed);
    std::normal_distribution<double> normal;
    auto all = exact_;
    for (mc::Measurement& one : all) {
      const Eigen::VectorXd error = share_ * one.values.cwiseAbs();
      one.covariance = error.cwiseAbs2().asDiagonal();
      for (Eigen::Index i = 0; i < error.size(); ++i) one.values[i] += error[i] * normal(random);
    }
    return all;
  }
  /// Returns the measurements without noise; their stated errors are `share` times each value.
  std::vector<mc::Measurement> exact(double share = 0.01) const {
    auto all = exact_;
    for (mc::Measurement& one : all) one.covariance = (share * one.values).cwiseAbs2().asDiagonal();
    return all;
  }

 private:
  Scene at_truth(SceneSpec spec) const {
    spec.g = truth_.g;
    spec.albedo = truth_.albedo;
    spec.optical_depth = truth_.optical_depth;
    return make_scene(spec);
  }
  static void add(mc::Curve& curve, double x, std::vector<double>& axis) {
    curve.entries.push_back(axis.size());
    curve.abscissa.push_back(x);
    axis.push_back(x);
  }
  void put_moving(mc::Curve& curve, double view) {
    curve.scene.view_angles = {view};
    for (std::size_t i = 0; i < curve.times.size(); ++i) curve.entries.push_back(i);
    const Scene scene = at_truth(curve.scene);
    const bool reversed = mc::needs_reversed(scene);
    auto found = mc::slab_covariance(scene, reversed, {1e-6}).value;
    for (const double delay : curve.delays)
      found.push_back(mc::slab_covariance(scene, reversed, {1e-6}, {.delay = delay}).value.front());
    put(curve, mc::observed(curve, beta, scene.request, found));
  }
  void put(const mc::Curve& curve, const std::vector<double>& values) {
    mc::Measurement one{"synthetic", {curve}, {}, {}};
    one.values =
        Eigen::Map<const Eigen::VectorXd>(values.data(), static_cast<Eigen::Index>(values.size()));
    exact_.push_back(one);
  }

  double depth_, share_;
  mc::MovingSpec slab_, truth_;
  std::vector<mc::Measurement> exact_;
};

/// Returns the task of fitting the parameters `free`; `set_known` sets the known values in the
/// scene of each curve.
inline mc::FitTask slab_task(
    std::vector<mc::Measurement> measurements, const std::vector<std::string>& free,
    const std::function<void(mc::MovingSpec& scene)>& set_known = [](mc::MovingSpec&) {}) {
  mc::MovingSpec none;
  none.scatterer = "hg";
  mc::FitTask task;
  task.free = mc::read_free_parameters(free, none);
  for (mc::Measurement& one : measurements)
    for (mc::Curve& curve : one.curves) set_known(curve.scene);
  task.measurements = std::move(measurements);
  return task;
}

/// Returns the task of fitting g, albedo and optical depth within fixed bounds.
inline mc::FitTask slab_task(std::vector<mc::Measurement> measurements, double thickest = 20) {
  return slab_task(std::move(measurements),
                   {"g=0.5:0.95", "albedo=0.9:1", "optical_depth=1:" + std::to_string(thickest)});
}

/// Returns a slab with curves for two detection directions in transmission and two in reflection,
/// and its transmittance.
inline SyntheticSlab standard_slab() {
  SyntheticSlab slab(2000, 0.8, 0.98, 4);
  for (const double view : {0.0, 0.3, std::numbers::pi - 0.44, std::numbers::pi - 0.84})
    slab.add_curve(view, {1.25, 2.5, 5, 10});
  slab.add_transmittance();
  return slab;
}

}  // namespace flatspeckle::bench
