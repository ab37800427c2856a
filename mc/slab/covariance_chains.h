#pragma once

#include <algorithm>
#include <cstddef>
#include <map>
#include <utility>
#include <vector>

#include "flatland/request/request.h"
#include "mc/slab/adding/angular_grid.h"
#include "mc/slab/adding/pair_wave.h"
#include "mc/slab/adding/slab.h"

namespace flatspeckle::mc {

/// A pair of illuminations and a pair of views. Pairs of paths that connect the first illumination
/// to the first view, and the second to the second, contribute to an entry of the request.
template <typename Direction>
struct ChainOf {
  PairOf<Direction> lights, views;
  std::size_t entry;
};

/// Returns the ladder chains of all entries and, if `reversed`, also those with the second path
/// reversed (C38). The wavenumber of the second field is larger by the fraction `shift`. The view
/// of the second field is turned so that the transverse momenta of lights and views match; the sine
/// of its new direction must be less than 1. If the slab has faces, chains whose two illuminations
/// enter through different faces are omitted: their fields oscillate against each other with depth
/// (PairInLayersOf).
template <typename Geometry, typename Number>
auto chains(const SlabOf<Geometry, Number>& slab,
            const RequestOf<typename Geometry::Direction>& request, bool reversed) {
  const double shift = slab.departure.shift;
  using PairOfEndpoints = PairOf<typename Geometry::Direction>;
  std::vector<ChainOf<typename Geometry::Direction>> all;
  for (std::size_t e = 0; e < request.entries.size(); ++e) {
    const Channel a = request.channels[request.entries[e].a],
                  b = request.channels[request.entries[e].b];
    const PairOfEndpoints lights{request.lights[a.light], request.lights[b.light]};
    PairOfEndpoints views{request.views[a.view], request.views[b.view]};
    if (shift != 0) views.second = Geometry::matched(lights, views, shift);
    all.push_back({lights, views, e});
    const bool opposite = cosine_of(lights.first) * cosine_of(views.second) > 0;
    if (reversed && !(opposite && slab.has_faces()))
      all.push_back({{lights.first, turned_round(views.second)},
                     {views.first, turned_round(lights.second)},
                     e});
  }
  return all;
}

/// Chains with the same transverse momentum and the same angular grid. Each chain is a Link, which
/// refers to its pair of illuminations and its pair of views by index.
template <typename Geometry>
struct ChainGroup {
  using Pairs = std::vector<PairOf<typename Geometry::Direction>>;

  typename Geometry::Momentum momentum;
  std::vector<Focus> foci;
  Pairs lights, views;
  struct Link {
    Eigen::Index light, view;
    std::size_t entry;
  };
  std::vector<Link> links;
};

/// Returns the index of a pair in a list, to which it is appended if missing.
template <typename Pair>
Eigen::Index listed(std::vector<Pair>& list, const Pair& pair) {
  const auto found = std::find(list.begin(), list.end(), pair);
  const auto number = static_cast<Eigen::Index>(found - list.begin());
  if (found == list.end()) list.push_back(pair);
  return number;
}

/// Groups chains by transverse momentum and angular grid.
template <typename Geometry, typename Number>
std::vector<ChainGroup<Geometry>> grouped(
    const SlabOf<Geometry, Number>& slab,
    const std::vector<ChainOf<typename Geometry::Direction>>& chains) {
  std::vector<PairOf<typename Geometry::Direction>> lights;
  for (const auto& chain : chains) lights.push_back(chain.lights);
  // The foci are angles in the layer of the largest refractive index.
  const double refraction = slab.outside_index / slab.largest_index();
  for (auto& pair : lights) pair = refracted(pair, refraction);
  const typename Geometry::Foci foci(lights, slab.mu_t * slab.depth, slab.width());
  std::map<std::pair<typename Geometry::Momentum, std::vector<Focus>>, ChainGroup<Geometry>> groups;
  for (const auto& chain : chains) {
    const auto momentum = Geometry::momentum(chain.lights, slab.k, slab.mu_t, slab.departure.shift);
    const auto own = foci.of(refracted(chain.lights, refraction), momentum);
    ChainGroup<Geometry>& group = groups[{momentum, own}];
    group.momentum = momentum;
    group.foci = own;
    group.links.push_back(
        {listed(group.lights, chain.lights), listed(group.views, chain.views), chain.entry});
  }
  std::vector<ChainGroup<Geometry>> list;
  for (auto& [key, group] : groups) list.push_back(std::move(group));
  return list;
}

}  // namespace flatspeckle::mc
