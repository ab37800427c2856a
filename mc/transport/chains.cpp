#include "mc/transport/chains.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>

namespace flatspeckle::mc {

namespace {

/// The angle in the first quadrant that has the same |sin|.
double folded(double angle) {
  const double from_z = std::abs(std::remainder(angle, 2 * std::numbers::pi));
  return std::min(from_z, std::numbers::pi - from_z);
}

/// One angle for lights that are near to each other in units of what a phase function resolves, so
/// that they share a grid.
class Foci {
 public:
  Foci(const std::vector<Chain>& chains, double width) : width_(width) {
    std::vector<double> all;
    for (const Chain& chain : chains)
      for (const double angle : {chain.lights.first, chain.lights.second})
        all.push_back(folded(angle));
    std::sort(all.begin(), all.end());
    for (const double angle : all)
      if (centres_.empty() || angle - centres_.back() > width / 2) centres_.push_back(angle);
  }

  std::vector<double> of(Pair lights) const {
    constexpr double all_circle = 0.4;  // no panel is split for such widths
    if (width_ > all_circle) return {};
    std::vector<double> found;
    for (const double angle : {folded(lights.first), folded(lights.second)}) {
      const double centre = *std::prev(std::upper_bound(centres_.begin(), centres_.end(), angle));
      if (std::find(found.begin(), found.end(), centre) == found.end()) found.push_back(centre);
    }
    std::sort(found.begin(), found.end());
    return found;
  }

 private:
  double width_;
  std::vector<double> centres_;
};

Eigen::Index number_of(std::vector<Pair>& list, Pair pair) {
  const auto found = std::find(list.begin(), list.end(), pair);
  if (found != list.end()) return found - list.begin();
  list.push_back(pair);
  return static_cast<Eigen::Index>(list.size()) - 1;
}

}  // namespace

std::vector<Chain> chains(const CovarianceRequest& request, bool reversed) {
  std::vector<Chain> all;
  for (std::size_t e = 0; e < request.entries.size(); ++e) {
    const auto angles = [&](std::size_t channel) {
      const Channel c = request.channels[channel];
      return Pair{request.lights[c.light].angle, request.views[c.view].angle};
    };
    const auto [i1, v1] = angles(request.entries[e].a);
    const auto [i2, v2] = angles(request.entries[e].b);
    all.push_back({{i1, i2}, {v1, v2}, e});
    if (reversed)
      all.push_back({{i1, v2 + std::numbers::pi}, {v1, i2 + std::numbers::pi}, e});
  }
  return all;
}

std::vector<ChainGroup> grouped(const Scene& scene, const ScatteringLaw& law,
                                const std::vector<Chain>& chains) {
  constexpr double same_momentum = 1e-12;  // of k
  const double unit = same_momentum * scene.k / scene.medium.mu_t;
  const Foci foci(chains, law.width());
  std::map<std::pair<double, std::vector<double>>, ChainGroup> groups;
  for (const Chain& chain : chains) {
    const double q = unit * std::round(transverse_momentum(scene, chain.lights) / unit);
    const auto centres = foci.of(chain.lights);
    ChainGroup& group = groups[{q, centres}];
    if (group.links.empty()) {
      group.q = q;
      for (const double centre : centres) group.foci.push_back({centre, law.width()});
    }
    group.links.push_back({number_of(group.lights, chain.lights),
                           number_of(group.views, chain.views), chain.entry});
  }
  std::vector<ChainGroup> list;
  for (auto& [key, group] : groups) list.push_back(std::move(group));
  return list;
}

}  // namespace flatspeckle::mc
