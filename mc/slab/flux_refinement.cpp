#include "mc/slab/flux_refinement.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/numbers/blas.h"
#include "core/run/interrupt.h"
#include "core/run/parallel.h"
#include "mc/jobs/flux_job.h"

namespace flatspeckle::mc {

namespace {

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

FluxSolution with_absorbed(const Scene& slab, double light, FluxSolution found) {
  auto& shares = found.shares;
  if (slab.medium.albedo < 1)
    shares[absorbed] =
        1 - direct_transmittance(slab, light) - shares[reflected] - shares[transmitted];
  return found;
}

Refined refined_shares(const Scene& slab, double light, const Refinement& refinement, int order,
                       const FluxSolver& solve) {
  FluxSolution before = with_absorbed(slab, light, solve(light, order));
  Refined found{before.shares, std::vector<Complex>(before.shares.size()), before.ordinates};
  for (double last = 1, worst = 1;
       worst > refinement.tolerance || last > 100 * refinement.tolerance;) {
    stop_if_interrupted();
    if (4 * found.ordinates > 3 * refinement.most_ordinates) break;
    order = Refinement::next_order(order);
    FluxSolution finer = with_absorbed(slab, light, solve(light, order));
    found = {finer.shares, finer.shares, finer.ordinates};
    for (std::size_t i = 0; i < before.shares.size(); ++i) found.difference[i] -= before.shares[i];
    last = std::exchange(worst, worst_difference(found));
    before = std::move(finer);
  }
  return found;
}

}  // namespace

Refined refined_flux(const Scene& slab, const Refinement& refinement, int first_order,
                     const FluxSolver& solve) {
  blas_single_thread();
  const auto lights = slab.request.lights.angles();
  std::vector<Refined> each(lights.size());
  parallel_for(lights.size(), [&](std::size_t i) {
    each[i] = refined_shares(slab, lights[i], refinement, first_order, solve);
  });
  Refined all;
  for (const Refined& light : each) all.append(light);
  return all;
}

Refined flux_of_absorber(const Scene& slab, std::size_t angle_bins) {
  Refined all;
  for (const double light : slab.request.lights.angles()) {
    std::vector<Complex> shares(flux_shares + angle_bins);
    shares[absorbed] = 1 - direct_transmittance(slab, light);
    all.append({shares, std::vector<Complex>(shares.size()), 0});
  }
  return all;
}

}  // namespace flatspeckle::mc
