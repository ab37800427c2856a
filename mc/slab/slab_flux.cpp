#include "mc/slab/slab_flux.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>

#include "mc/jobs/flux_job.h"
#include "mc/slab/flux_refinement.h"
#include "mc/slab/layer_stack.h"
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

/// What leaves of a unit light, by parity.
using Leaving = std::function<LayerResponse(Parity)>;

Faces faces(double light, const AngularGrid& grid, const Leaving& leaving) {
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
FluxSolution solution(double light, std::size_t bins, const AngularGrid& grid,
                      const Leaving& leaving) {
  const Faces exits = faces(light, grid, leaving);
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

AngularGrid grid_of(double light, const ScatteringLaw& law, int order) {
  return AngularGrid(light_foci({light, light}, law.width()), order, law.width());
}

FluxSolution of_slab(const Scene& scene, double light, std::size_t bins, const ScatteringLaw& law,
                     int order) {
  const AngularGrid grid = grid_of(light, law, order);
  const ScatteringMatrices matrices(grid, law, scene.medium.albedo);
  const double depth = scene.medium.mu_t * scene.domain.depth;
  return solution(light, bins, grid, [&](Parity parity) {
    const auto [lights, views] = matrices.ends(scene, {{light, light}}, {}, parity);
    return layer_response(matrices.transport(0, parity), depth, lights, views);
  });
}

FluxSolution of_layers(const std::vector<OneLayer>& layers, double light, std::size_t bins,
                       int order) {
  const AngularGrid grid = grid_of(light, narrowest_law(layers), order);
  const LayerMatrices matrices = layer_matrices(layers, grid);
  return solution(light, bins, grid, [&](Parity parity) {
    return stack_response(stacked(layers, matrices, 0, {{light, light}}, {}, parity));
  });
}

}  // namespace

Refined slab_flux(const Scene& slab, std::size_t angle_bins, const Refinement& refinement) {
  if (slab.medium.mu_s == 0) return flux_of_absorber(slab, angle_bins);
  const auto refined = [&](int least, const FluxSolver& solve) {
    return refined_flux(slab, refinement, std::max(refinement.first_order(), least), solve);
  };
  if (slab.profile) {
    const auto layers = layers_of(slab);
    return refined(least_order(layers), [&](double light, int order) {
      return of_layers(layers, light, angle_bins, order);
    });
  }
  const ScatteringLaw law(slab);
  return refined(law.least_order(), [&](double light, int order) {
    return of_slab(slab, light, angle_bins, law, order);
  });
}

FluxJob slab_flux_job(const Scene& slab, std::size_t angle_bins, const Refinement& refinement) {
  FluxJob job{
      {}, slab.request.lights.size(), angle_bins, "intensity alone in the plane, by doubling"};
  job.batches = two_batches(job.lights * (flux_shares + angle_bins),
                            [=] { return slab_flux(slab, angle_bins, refinement); });
  return job;
}

}  // namespace flatspeckle::mc
