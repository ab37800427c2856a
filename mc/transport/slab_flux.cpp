#include "mc/transport/slab_flux.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "core/numbers/blas.h"
#include "core/run/interrupt.h"
#include "core/run/parallel.h"
#include "mc/estimators/flux_walk.h"
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
std::vector<Complex> shares(const Scene& scene, double light, std::size_t bins,
                            const ScatteringLaw& law, int order, int& ordinates) {
  const AngularGrid grid(light_foci({light, light}, law.width()), order, law.width());
  const ScatteringMatrices matrices(grid, law, scene.medium.albedo);
  const Faces exits = faces(scene, light, grid, matrices);
  ordinates = static_cast<int>(2 * grid.size());
  std::vector<Complex> found(flux_shares + bins);
  found[reflected] =
      share_within(exits, grid, -pi, -pi / 2) + share_within(exits, grid, pi / 2, pi);
  found[transmitted] = share_within(exits, grid, -pi / 2, pi / 2);
  if (scene.medium.albedo < 1)
    found[absorbed] =
        1 - direct_transmittance(scene, light) - found[reflected] - found[transmitted];
  const double width = 2 * pi / static_cast<double>(bins);
  for (std::size_t bin = 0; bin < bins; ++bin) {
    const double from = static_cast<double>(bin) * width - pi;
    found[flux_shares + bin] = share_within(exits, grid, from, from + width);
  }
  return found;
}

/// Of what leaves through a face relative to itself; of bins relative to all that leaves, and a
/// hundredth of it, for peaks of large disks would take a hundred times as long.
double worst_difference(const Refined& shares) {
  double worst = 0, leaving = 0;
  for (const FluxShare share : {reflected, transmitted}) {
    worst = std::max(worst, std::abs(shares.difference[share] / shares.value[share]));
    leaving += shares.value[share].real();
  }
  for (std::size_t i = flux_shares; i < shares.value.size(); ++i)
    worst = std::max(worst, std::abs(shares.difference[i]) / leaving / 100);
  return worst;
}

Refined refined_shares(const Scene& scene, double light, std::size_t bins, const ScatteringLaw& law,
                       const Refinement& refinement) {
  Refined found;
  int order = std::max(refinement.first_order(), law.least_order());
  auto before = shares(scene, light, bins, law, order, found.ordinates);
  for (double last = 1, worst = 1;
       worst > refinement.tolerance || last > 100 * refinement.tolerance;) {
    stop_if_interrupted();
    if (4 * found.ordinates > 3 * refinement.most_ordinates) break;
    order = Refinement::next_order(order);
    found.value = shares(scene, light, bins, law, order, found.ordinates);
    found.difference = found.value;
    for (std::size_t i = 0; i < before.size(); ++i) found.difference[i] -= before[i];
    last = std::exchange(worst, worst_difference(found));
    before = found.value;
  }
  return found;
}

}  // namespace

Refined slab_flux(const Scene& slab, std::size_t angle_bins, const Refinement& refinement) {
  const auto lights = slab.request.lights.angles();
  const std::size_t size = flux_shares + angle_bins;
  Refined all{std::vector<Complex>(lights.size() * size),
              std::vector<Complex>(lights.size() * size), 0};
  if (slab.medium.mu_s == 0) {
    for (std::size_t i = 0; i < lights.size(); ++i)
      all.value[i * size + absorbed] = 1 - direct_transmittance(slab, lights[i]);
    return all;
  }
  blas_single_thread();
  const ScatteringLaw law(slab);
  std::vector<Refined> each(lights.size());
  parallel_for(lights.size(), [&](std::size_t i) {
    each[i] = refined_shares(slab, lights[i], angle_bins, law, refinement);
  });
  for (std::size_t i = 0; i < lights.size(); ++i) {
    const auto at = static_cast<std::ptrdiff_t>(i * size);
    std::copy(each[i].value.begin(), each[i].value.end(), all.value.begin() + at);
    std::copy(each[i].difference.begin(), each[i].difference.end(), all.difference.begin() + at);
    all.ordinates = std::max(all.ordinates, each[i].ordinates);
  }
  return all;
}

FluxJob slab_flux_job(const Scene& slab, std::size_t angle_bins, const Refinement& refinement) {
  FluxJob job{{}, slab.request.lights.size(), angle_bins, "intensity alone, by doubling"};
  job.batches = two_batches(job.lights * (flux_shares + angle_bins),
                            [=] { return slab_flux(slab, angle_bins, refinement); });
  return job;
}

}  // namespace flatspeckle::mc
