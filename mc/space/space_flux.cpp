#include "mc/space/space_flux.h"

#include <cmath>
#include <numbers>
#include <numeric>

#include "mc/jobs/flux_job.h"
#include "mc/slab/flux_refinement.h"
#include "mc/space/azimuthal_modes.h"
#include "mc/space/space_scene.h"

namespace flatspeckle::mc {

namespace {

using std::numbers::pi;

/// Power that leaves through a face, over what enters: all, and per radian of the polar angle at
/// the ordinates.
struct Exit {
  double share;
  Eigen::VectorXd per_radian;
};
struct Faces {
  Exit reflected, transmitted;
};

/// Eigen's own makes gcc 12 warn of AVX-512's header.
double sum_of_products(const Eigen::VectorXd& a, const Eigen::VectorXd& b) {
  return std::inner_product(a.begin(), a.end(), b.begin(), 0.0);
}

/// Without momentum, of the mode m = 0 alone.
Faces faces(const SpaceSlab& slab, double angle, const PolarMatricesOf<double>& polar) {
  const AzimuthalModesOf<double> modes(polar, slab, 0);
  const Eigen::Vector3d light(std::sin(angle), 0, std::cos(angle));
  const auto [lights, views] = modes.ends({1, 0}, {{light, light}}, {});
  const auto response = layer_response(modes.transport(0, modes.parts(0).front()),
                                       slab.optical_depth(), lights, views);
  const AngularGrid& grid = polar.grid();
  const Eigen::VectorXd power = modes.power() / light.z();
  const Eigen::ArrayXd per_radian = power.array() * grid.angle().array().sin() *
                                    grid.cosine().array() / polar.root().array().square();
  const auto exit = [&](const Rows& rows) -> Exit {
    const Eigen::VectorXd unknowns = rows.row(0).real();
    return {sum_of_products(unknowns, power), unknowns.array() * per_radian};
  };
  return {exit(response.up), exit(response.down)};
}

/// As the sums of a light in a FluxJob.
FluxSolution solution(const SpaceSlab& slab, double angle, std::size_t bins, int order) {
  const PolarMatricesOf<double> polar({{angle, slab.law.width()}}, order, slab.law, slab.albedo);
  const AngularGrid& grid = polar.grid();
  const Faces exits = faces(slab, angle, polar);
  FluxSolution found{std::vector<Complex>(flux_shares + bins), static_cast<int>(2 * grid.size())};
  found.shares[reflected] = exits.reflected.share;
  found.shares[transmitted] = exits.transmitted.share;
  const double width = pi / static_cast<double>(bins);
  for (std::size_t bin = 0; bin < bins; ++bin) {
    const double from = static_cast<double>(bin) * width, to = from + width;
    found.shares[flux_shares + bin] =
        sum_of_products(grid.interval_integrals(from, to), exits.transmitted.per_radian) +
        sum_of_products(grid.interval_integrals(pi - to, pi - from), exits.reflected.per_radian);
  }
  return found;
}

}  // namespace

Refined space_flux(const Scene& scene, std::size_t angle_bins, const Refinement& refinement) {
  if (scene.medium.mu_s == 0) return flux_of_absorber(scene, angle_bins);
  const SpaceSlab slab = space_slab(scene);
  return refined_flux(scene, refinement, refinement.first_order(), [&](double light, int order) {
    return solution(slab, std::abs(light), angle_bins, order);
  });
}

FluxJob space_flux_job(const Scene& slab, std::size_t angle_bins, const Refinement& refinement) {
  FluxJob job{{}, slab.request.lights.size(), angle_bins, "intensity alone in space, by doubling"};
  job.angles = pi;
  job.batches = two_batches(job.lights * (flux_shares + angle_bins),
                            [=] { return space_flux(slab, angle_bins, refinement); });
  return job;
}

}  // namespace flatspeckle::mc
