#include "bench/stability/mc_extremes_fit.h"

#include "bench/scenes/synthetic_slab.h"

namespace flatspeckle::bench {

namespace {

struct Truth {
  double g, albedo, optical_depth;
};

/// How far the parameters are off, in the errors that 1 % of noise would give them.
Finding found_again(const Truth& truth, const std::vector<std::string>& free) {
  constexpr double depth = 20000;  // few paths walked backwards count
  SyntheticSlab slab(depth, truth.g, truth.albedo, truth.optical_depth);
  for (const double view : {0.2, std::numbers::pi - 0.6}) slab.add_curve(view, {1, 2, 4, 8});
  slab.add_transmittance();
  mc::FitTask task = slab_task(slab.exact());
  mc::MovingSpec none;
  none.scatterer = "hg";
  task.free = mc::read_free_parameters(free, none);
  const mc::MediumFit fit = mc::fit_medium(task);
  const Eigen::VectorXd off =
      fit.estimates - Eigen::VectorXd{{truth.g, truth.albedo, truth.optical_depth}};
  return {fit.converged ? off.cwiseQuotient(fit.errors).cwiseAbs().maxCoeff() : 1e9, 0.2};
}

/// g alone, by paths: how far it is off, in standard errors of their chance.
Finding found_by_paths(const Truth& truth) {
  SyntheticSlab slab(2000, truth.g, truth.albedo, truth.optical_depth);
  for (const double view : {0.3, std::numbers::pi - 0.6}) slab.add_curve(view, {1, 2, 4, 8});
  mc::FitTask task = slab_task(slab.exact());
  for (mc::Measurement& one : task.measurements)
    for (mc::Curve& curve : one.curves) {
      curve.scene.albedo = truth.albedo;
      curve.scene.optical_depth = truth.optical_depth;
    }
  task.free = mc::read_free_parameters({"g=-0.5:0.99"}, {});
  task.paths.emplace();
  const mc::MediumFit fit = mc::fit_medium(task);
  const double off = std::abs(fit.estimates[0] - truth.g);
  return {fit.converged ? off / std::sqrt(fit.by_chance(0, 0)) : 1e9, 4};
}

/// How far the diffusion is off that a decay tells of, in a medium that is known.
Finding diffusion_again(double optical_depth, const std::vector<double>& delays) {
  SyntheticSlab slab(2000, 0.8, 1, optical_depth);
  slab.add_decay(0.2, delays);
  mc::FitTask task = slab_task(slab.exact());
  for (mc::Curve& curve : task.measurements.front().curves) {
    curve.scene.g = 0.8;
    curve.scene.optical_depth = optical_depth;
  }
  task.free = mc::read_free_parameters({"diffusion=0.001:1000"}, {});
  const mc::MediumFit fit = mc::fit_medium(task);
  return {fit.converged ? std::abs(fit.estimates[0] - 1) / fit.errors[0] : 1e9, 0.2};
}

}  // namespace

void add_fits(ExtremeRows& rows) {
  const auto add = [&](const std::string& name, const Truth& truth,
                       const std::vector<std::string>& free) {
    rows.add_slow("fit of a slab, " + name,
                  "parameters of exact curves, in standard errors of 1 % noise",
                  [=] { return found_again(truth, free); });
  };
  const std::string albedo = "albedo=0.8:1";
  add("OD 0.1, g 0.9", {0.9, 0.95, 0.1}, {"g=0.3:0.98", albedo, "optical_depth=0.01:3"});
  add("OD 15, g 0.95", {0.95, 0.99, 15}, {"g=0.3:0.99", albedo, "optical_depth=1:60"});
  add("OD 10, g 0", {0, 0.9, 10}, {"g=-0.5:0.9", albedo, "optical_depth=1:60"});
  const auto add_paths = [&](const std::string& name, const Truth& truth) {
    rows.add_slow("fit by paths, " + name, "g of exact curves, in standard errors of chance",
                  [=] { return found_by_paths(truth); });
  };
  add_paths("OD 0.05, g 0.9", {0.9, 0.95, 0.05});
  add_paths("OD 20, g 0.95", {0.95, 0.99, 20});
  add_paths("OD 10, albedo 1e-3", {0.3, 1e-3, 10});
  const auto add_diffusion = [&](const std::string& name, double optical_depth,
                                 const std::vector<double>& delays) {
    rows.add_slow("fit of a decay, " + name, "diffusion, in standard errors of 1 % noise",
                  [=] { return diffusion_again(optical_depth, delays); });
  };
  add_diffusion("OD 0.01, single scattering", 0.01, {1, 5, 20});
  add_diffusion("OD 60, most of it gone", 60, {1e-4, 1e-3, 1e-2});
  add("albedo 1, its bound", {0.7, 1, 5}, {"g=0.3:0.98", albedo, "optical_depth=1:60"});
}

}  // namespace flatspeckle::bench
