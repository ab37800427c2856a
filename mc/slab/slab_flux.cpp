#include "mc/slab/slab_flux.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "mc/estimators/flux_walk.h"
#include "mc/slab/flux_refinement.h"
#include "mc/transport/chains.h"
#include "mc/transport/scattering_matrices.h"

namespace flatspeckle::mc {

namespace {

using std::numbers::pi;
using Parity = ScatteringMatrices::Parity;

/// Power that leaves through a face per ordinate, over its weight and the power that enters: of
/// directions with sin > 0, and of their mirror images.
struct Exits {
  Eigen::VectorXd right, left;
};

struct Faces {
  Exits reflected, transmitted;
};

Faces faces(const Scene& scene, double light, const AngularGrid& grid,
            const ScatteringMatrices& matrices) {
  const double depth = scene.medium.mu_t * scene.domain.depth;
  const auto leaving = [&](Parity parity) {
    const auto [lights, views] = matrices.ends(scene, {{light, light}}, {}, parity);
    return layer_response(matrices.transport(0, parity), depth, lights, views);
  };
  const auto even = leaving(Parity::even), odd = leaving(Parity::odd);
  const auto exits = [&](const Rows& of_even, const Rows& of_odd) {
    Exits found{Eigen::VectorXd(grid.size()), Eigen::VectorXd(grid.size())};
    for (Eigen::Index j = 0; j < grid.size(); ++j) {
      const double factor = std::sqrt(grid.cosine()[j] / (2 * grid.weight()[j])) / std::cos(light),
                   e = of_even(0, j).real(), o = of_odd(0, j).imag();
      found.right[j] = factor * (e + o);
      found.left[j] = factor * (e - o);
    }
    return found;
  };
  return {exits(even.up, odd.up), exits(even.down, odd.down)};
}

/// Share within [from, to], -pi <= from < to <= pi, quadrant by quadrant.
double share_within(const Faces& faces, const AngularGrid& grid, double from, double to) {
  const auto quadrant = [&](const Eigen::VectorXd& exit, double low, double high) {
    const auto integrals = grid.interval_integrals(low, high);
    double sum = 0;
    for (Eigen::Index j = 0; j < exit.size(); ++j) sum += integrals[j] * exit[j];
    return sum;
  };
  return quadrant(faces.transmitted.right, from, to) +
         quadrant(faces.transmitted.left, -to, -from) +
         quadrant(faces.reflected.right, pi - to, pi - from) +
         quadrant(faces.reflected.left, from + pi, to + pi);
}

/// As the sums of a light in a FluxJob.
FluxSolution solution(const Scene& scene, double light, std::size_t bins, const ScatteringLaw& law,
                      int order) {
  const AngularGrid grid(light_foci({light, light}, law.width()), order, law.width());
  const ScatteringMatrices matrices(grid, law, scene.medium.albedo);
  const Faces exits = faces(scene, light, grid, matrices);
  FluxSolution found{std::vector<Complex>(flux_shares + bins), static_cast<int>(2 * grid.size())};
  auto& shares = found.shares;
  shares[reflected] =
      share_within(exits, grid, -pi, -pi / 2) + share_within(exits, grid, pi / 2, pi);
  shares[transmitted] = share_within(exits, grid, -pi / 2, pi / 2);
  const double width = 2 * pi / static_cast<double>(bins);
  for (std::size_t bin = 0; bin < bins; ++bin) {
    const double from = static_cast<double>(bin) * width - pi;
    shares[flux_shares + bin] = share_within(exits, grid, from, from + width);
  }
  return found;
}

}  // namespace

Refined slab_flux(const Scene& slab, std::size_t angle_bins, const Refinement& refinement) {
  if (slab.medium.mu_s == 0) return flux_of_absorber(slab, angle_bins);
  const ScatteringLaw law(slab);
  return refined_flux(
      slab, refinement, std::max(refinement.first_order(), law.least_order()),
      [&](double light, int order) { return solution(slab, light, angle_bins, law, order); });
}

FluxJob slab_flux_job(const Scene& slab, std::size_t angle_bins, const Refinement& refinement) {
  FluxJob job{
      {}, slab.request.lights.size(), angle_bins, "intensity alone in the plane, by doubling"};
  job.batches = two_batches(job.lights * (flux_shares + angle_bins),
                            [=] { return slab_flux(slab, angle_bins, refinement); });
  return job;
}

}  // namespace flatspeckle::mc
