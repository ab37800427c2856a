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
  SceneSpec none;
  none.scatterer = "hg";
  task.free = mc::read_free_parameters(free, none);
  const mc::MediumFit fit = mc::fit_medium(task);
  const Eigen::VectorXd off =
      fit.estimates - Eigen::VectorXd{{truth.g, truth.albedo, truth.optical_depth}};
  return {fit.converged ? off.cwiseQuotient(fit.errors).cwiseAbs().maxCoeff() : 1e9, 0.2};
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
  add("albedo 1, its bound", {0.7, 1, 5}, {"g=0.3:0.98", albedo, "optical_depth=1:60"});
}

}  // namespace flatspeckle::bench
