#include "mc/space/space_covariance.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>

#include "core/algebra/divided_difference.h"
#include "core/numbers/blas.h"
#include "core/run/parallel.h"
#include "mc/space/azimuthal_modes.h"

namespace flatspeckle::mc {

namespace {

/// Nodes of a panel, and the highest mode of the azimuth.
struct Resolution {
  int order, modes;

  Resolution finer_order() const { return {Refinement::next_order(order), modes}; }
  Resolution finer_modes() const { return {order, Refinement::next_order(modes)}; }
};

template <typename Number>
ComplexOf<Number> scattered_once(const SpaceSlabOf<Number>& slab, const SpaceChain& chain) {
  using C = ComplexOf<Number>;
  const double k = slab.k_per_mu_t();
  const RealOf<Number> depth = slab.optical_depth();
  const auto light = pair_wave(k, chain.lights, slab.departure),
             view = pair_wave(k, turned_round(chain.views), slab.departure);
  return slab.albedo * depth *
         slab.law.pair(chain.lights.first.dot(chain.views.first),
                       chain.lights.second.dot(chain.views.second)) *
         divided_difference(C(depth * (light.top + view.top)),
                            C(depth * (light.bottom + view.bottom)));
}

double norm(const Rows& rows) {
  return rows.norm();
}
double norm(const Dual<Rows>& rows) {
  return rows.value.norm() + rows.slope.norm();
}

template <typename Number>
bool is_dark(const PairWavesOf<Number>& part, const PairWavesOf<Number>& all) {
  constexpr double rounding = 1e-13;
  return norm(part.down) + norm(part.up) <= rounding * (norm(all.down) + norm(all.up));
}

/// Paths of two scatterings and more: values per link of a group, then derivatives if there are.
struct Solution {
  std::vector<Complex> value;
  int ordinates = 0;  ///< of both ways, times azimuthal functions that are coupled
};

template <typename Number>
Solution solve_group(const SpaceSlabOf<Number>& slab, const SpaceGroup& group,
                     Resolution resolution, PolarMatrixList<RealOf<Number>>& polar) {
  const double q = slab.k_per_mu_t() * group.momentum.norm();
  const Eigen::Vector2d x = q == 0 ? Eigen::Vector2d(1, 0) : group.momentum.normalized();
  const AzimuthalModesOf<Number> modes(polar.at(group.foci, resolution.order), slab,
                                       resolution.modes);
  const auto [lights, views] = modes.ends(x, group.lights, group.views);
  std::vector<ComplexOf<Number>> value(group.links.size());
  int ordinates = 0;
  for (const auto& part : modes.parts(q)) {
    const auto fed = modes.part_of(lights, part), seen = modes.part_of(views, part);
    if (is_dark(fed, lights) || is_dark(seen, views)) continue;
    const auto medium = modes.transport(q, part);
    ordinates = std::max(ordinates, static_cast<int>(2 * value_of(medium.x).cols()));
    const auto response = layer_response(medium, slab.optical_depth(), fed, seen);
    for (std::size_t i = 0; i < group.links.size(); ++i)
      value[i] += entry(response.collected, group.links[i].view, group.links[i].light);
  }
  return {flat(value), ordinates};
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
template <typename Number>
class GroupRefiner {
 public:
  using Slab = SpaceSlabOf<Number>;
  using PolarList = PolarMatrixList<RealOf<Number>>;

  GroupRefiner(const Slab& slab, const SpaceGroup& group, const Refinement& refinement,
               PolarList& polar)
      : slab_(slab),
        group_(group),
        refinement_(refinement),
        polar_(polar),
        resolution_{refinement.first_order(), 2},
        coarse_(solved(resolution_)) {}

  const std::vector<Complex>& first() const { return coarse_.value; }

  /// Values and differences; scale: of each value.
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

  const Slab& slab_;
  const SpaceGroup& group_;
  Refinement refinement_;
  PolarList& polar_;
  Resolution resolution_;
  Solution coarse_;
};

/// Of a group's value: values of links go to those of their entries, derivatives to derivatives.
std::size_t entry_of(const SpaceGroup& group, std::size_t i, std::size_t entries) {
  const std::size_t links = group.links.size();
  return i / links * entries + group.links[i % links].entry;
}

void add_links(const SpaceGroup& group, const std::vector<Complex>& values, std::size_t size,
               std::vector<Complex>& entries) {
  for (std::size_t i = 0; i < values.size(); ++i) entries[entry_of(group, i, size)] += values[i];
}

template <typename Number>
Refined of_one_scattering(const SpaceSlabOf<Number>& slab, const std::vector<SpaceChain>& chains,
                          std::size_t size) {
  std::vector<ComplexOf<Number>> once(size);
  for (const SpaceChain& chain : chains) once[chain.entry] += scattered_once(slab, chain);
  Refined found{flat(once), {}, 0};
  found.difference.resize(found.value.size());
  return found;
}

template <typename Number>
Refined refined_covariance(const SpaceSlabOf<Number>& slab, const SpaceRequest& request,
                           bool reversed, const Refinement& refinement) {
  const std::size_t size = request.entries.size();
  const double shift = slab.departure.shift;
  auto chains = ladders(request, shift);
  Refined all = of_one_scattering(slab, chains, size);
  if (value_of(slab.albedo) == 0) return all;
  blas_single_thread();
  if (reversed)
    for (const SpaceChain& chain : reversed_ladders(request, shift)) chains.push_back(chain);
  const auto groups = grouped(chains, slab.law.width(), shift);
  PolarMatrixList<RealOf<Number>> polar(slab.law, slab.albedo);
  std::vector<std::unique_ptr<GroupRefiner<Number>>> refiners(groups.size());
  parallel_for(groups.size(), [&](std::size_t g) {
    refiners[g] = std::make_unique<GroupRefiner<Number>>(slab, groups[g], refinement, polar);
  });
  auto first = all.value;
  for (std::size_t g = 0; g < groups.size(); ++g)
    add_links(groups[g], refiners[g]->first(), size, first);
  const auto scale = scales_with_slopes(request.entries, first);
  std::vector<Refined> refined(groups.size());
  parallel_for(groups.size(), [&](std::size_t g) {
    std::vector<double> of_links;
    for (std::size_t i = 0; i < refiners[g]->first().size(); ++i)
      of_links.push_back(scale[entry_of(groups[g], i, size)]);
    refined[g] = refiners[g]->refined(of_links);
  });
  for (std::size_t g = 0; g < groups.size(); ++g) {
    add_links(groups[g], refined[g].value, size, all.value);
    add_links(groups[g], refined[g].difference, size, all.difference);
    all.ordinates = std::max(all.ordinates, refined[g].ordinates);
  }
  return all;
}

}  // namespace

template <typename Number>
Refined space_covariance(const SpaceSlabOf<Number>& slab, const SpaceRequest& request,
                         bool reversed, const Refinement& refinement) {
  return refined_covariance(slab, request, reversed, refinement);
}

template Refined space_covariance(const SpaceSlab&, const SpaceRequest&, bool, const Refinement&);
template Refined space_covariance(const SpaceSlabOf<Complex>&, const SpaceRequest&, bool,
                                  const Refinement&);
template Refined space_covariance(const SpaceSlabOf<Dual<double>>&, const SpaceRequest&, bool,
                                  const Refinement&);

}  // namespace flatspeckle::mc
