#include "mc/space/space_covariance.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>

#include "core/numbers/blas.h"
#include "core/run/parallel.h"
#include "mc/space/azimuthal_modes.h"
#include "mc/transport/divided_difference.h"

namespace flatspeckle::mc {

namespace {

/// Nodes of a panel, and the highest mode of the azimuth.
struct Resolution {
  int order, modes;

  Resolution finer_order() const { return {Refinement::next_order(order), modes}; }
  Resolution finer_modes() const { return {order, Refinement::next_order(modes)}; }
};

Complex scattered_once(const SpaceSlab& slab, const SpaceChain& chain) {
  const double k = slab.k / slab.mu_t, depth = slab.optical_depth();
  const PairWave light = pair_wave(k, chain.lights), view = pair_wave(k, turned_round(chain.views));
  return slab.albedo * depth *
         slab.law.pair(chain.lights.first.dot(chain.views.first),
                       chain.lights.second.dot(chain.views.second)) *
         divided_difference(depth * (light.top + view.top), depth * (light.bottom + view.bottom));
}

bool is_dark(const PairWaves& part, const PairWaves& all) {
  constexpr double rounding = 1e-13;
  return part.down.norm() + part.up.norm() <= rounding * (all.down.norm() + all.up.norm());
}

/// Paths of two scatterings and more, one value per link of a group.
struct Solution {
  std::vector<Complex> value;
  int ordinates = 0;  ///< of both ways, times azimuthal functions that are coupled
};

Solution solve_group(const SpaceSlab& slab, const SpaceGroup& group, Resolution resolution,
                     PolarMatricesOf& polar) {
  const double k = slab.k / slab.mu_t, q = k * group.momentum.norm();
  const Eigen::Vector2d x = q == 0 ? Eigen::Vector2d(1, 0) : group.momentum.normalized();
  const AzimuthalModes modes(polar.at(group.foci, resolution.order), slab.law, slab.albedo,
                             resolution.modes);
  const auto lights = modes.lights(k, x, group.lights), views = modes.views(k, x, group.views);
  Solution found{std::vector<Complex>(group.links.size())};
  for (const auto& part : modes.parts(q)) {
    const auto fed = modes.part_of(lights, part), seen = modes.part_of(views, part);
    if (is_dark(fed, lights) || is_dark(seen, views)) continue;
    const auto response = layer_response(modes.transport(q, part), slab.optical_depth(), fed, seen);
    for (std::size_t i = 0; i < group.links.size(); ++i)
      found.value[i] += response.collected(group.links[i].view, group.links[i].light);
    found.ordinates = std::max(found.ordinates, static_cast<int>(2 * response.up.cols()));
  }
  return found;
}

std::vector<Complex> operator-(std::vector<Complex> a, const std::vector<Complex>& b) {
  for (std::size_t i = 0; i < a.size(); ++i) a[i] -= b[i];
  return a;
}

std::vector<Complex> operator+(std::vector<Complex> a, const std::vector<Complex>& b) {
  for (std::size_t i = 0; i < a.size(); ++i) a[i] += b[i];
  return a;
}

double worst_of(const std::vector<Complex>& change, const std::vector<double>& scale) {
  double worst = 0;
  for (std::size_t i = 0; i < change.size(); ++i)
    if (scale[i] > 0) worst = std::max(worst, std::abs(change[i]) / scale[i]);
  return worst;
}

/// A group, refined on its own.
class GroupRefiner {
 public:
  GroupRefiner(const SpaceSlab& slab, const SpaceGroup& group, const Refinement& refinement,
               PolarMatricesOf& polar)
      : slab_(slab),
        group_(group),
        refinement_(refinement),
        polar_(polar),
        resolution_{refinement.first_order, 2},
        coarse_(solved(resolution_)) {}

  const std::vector<Complex>& first() const { return coarse_.value; }

  /// Values and differences; scale: per link.
  Refined refined(const std::vector<double>& scale) {
    const double tolerance = refinement_.tolerance / 2;
    for (bool near = false;;) {
      const Solution finer = solved(resolution_.finer_order()),
                     wider = solved(resolution_.finer_modes());
      const auto by_order = finer.value - coarse_.value, by_modes = wider.value - coarse_.value;
      const double of_order = worst_of(by_order, scale), of_modes = worst_of(by_modes, scale);
      const double worst = std::max(of_order, of_modes);
      const int ordinates = std::max(finer.ordinates, wider.ordinates);
      // One small difference may be chance: the one before must have been small too.
      if ((worst <= tolerance && near) || 4 * ordinates > 3 * refinement_.most_ordinates)
        return {coarse_.value + by_order + by_modes, by_order + by_modes, ordinates};
      near = worst <= 100 * tolerance;
      const bool refine_order = of_order > tolerance || worst <= tolerance,
                 refine_modes = of_modes > tolerance || worst <= tolerance;
      if (refine_order) resolution_ = resolution_.finer_order();
      if (refine_modes) resolution_ = resolution_.finer_modes();
      coarse_ = refine_order && refine_modes ? solved(resolution_) : refine_order ? finer : wider;
    }
  }

 private:
  Solution solved(Resolution resolution) const {
    return solve_group(slab_, group_, resolution, polar_);
  }

  const SpaceSlab& slab_;
  const SpaceGroup& group_;
  Refinement refinement_;
  PolarMatricesOf& polar_;
  Resolution resolution_;
  Solution coarse_;
};

/// Adds values of a group to those of entries.
void add_links(const SpaceGroup& group, const std::vector<Complex>& values,
               std::vector<Complex>& entries) {
  for (std::size_t i = 0; i < group.links.size(); ++i) entries[group.links[i].entry] += values[i];
}

}  // namespace

Refined space_covariance(const SpaceSlab& slab, const SpaceRequest& request, bool reversed,
                         const Refinement& refinement) {
  const std::size_t size = request.entries.size();
  Refined all{std::vector<Complex>(size), std::vector<Complex>(size), 0};
  if (slab.albedo == 0) return all;
  blas_single_thread();
  auto chains = ladders(request);
  for (const SpaceChain& chain : chains) all.value[chain.entry] += scattered_once(slab, chain);
  if (reversed)
    for (const SpaceChain& chain : reversed_ladders(request)) chains.push_back(chain);
  const auto groups = grouped(chains, slab.law.width());
  PolarMatricesOf polar(slab.law, slab.albedo);
  std::vector<std::unique_ptr<GroupRefiner>> refiners(groups.size());
  parallel_for(groups.size(), [&](std::size_t g) {
    refiners[g] = std::make_unique<GroupRefiner>(slab, groups[g], refinement, polar);
  });
  auto first = all.value;
  for (std::size_t g = 0; g < groups.size(); ++g) add_links(groups[g], refiners[g]->first(), first);
  const auto scale = scales(request.entries, first);
  std::vector<Refined> refined(groups.size());
  parallel_for(groups.size(), [&](std::size_t g) {
    std::vector<double> of_links;
    for (const auto& link : groups[g].links) of_links.push_back(scale[link.entry]);
    refined[g] = refiners[g]->refined(of_links);
  });
  for (std::size_t g = 0; g < groups.size(); ++g) {
    add_links(groups[g], refined[g].value, all.value);
    add_links(groups[g], refined[g].difference, all.difference);
    all.ordinates = std::max(all.ordinates, refined[g].ordinates);
  }
  return all;
}

}  // namespace flatspeckle::mc
