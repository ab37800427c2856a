#include "mc/transport/chains.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>

#include "flatland/scene/frequency_shift.h"

namespace flatspeckle::mc {

namespace {

/// The angle in the first quadrant that has the same |sin|.
double folded(double angle) {
  const double from_z = std::abs(std::remainder(angle, 2 * std::numbers::pi));
  return std::min(from_z, std::numbers::pi - from_z);
}

void add(std::vector<Focus>& foci, double angle, double width) {
  constexpr double too_wide = 0.4;  // for any panel to be split
  if (width < too_wide) foci.push_back({angle, width});
}

/// Foci of pairs of lights. Lights that are near to each other, in units of what the phase function
/// resolves, have one, so that their pairs share a grid.
class Foci {
 public:
  Foci(const Scene& scene, const std::vector<Chain>& chains, double width)
      : scene_(scene), width_(width) {
    std::vector<double> all;
    for (const Chain& chain : chains)
      for (const double angle : {chain.lights.first, chain.lights.second})
        all.push_back(folded(angle));
    std::sort(all.begin(), all.end());
    for (const double angle : all)
      if (centres_.empty() || angle - centres_.back() > width / 2) centres_.push_back(angle);
  }

  std::vector<Focus> of(Pair lights, double q) const {
    std::vector<Focus> found;
    for (const double angle : {folded(lights.first), folded(lights.second)})
      add(found, *std::prev(std::upper_bound(centres_.begin(), centres_.end(), angle)), width_);
    // Uniform panels resolve the phase of some ten turns with fewer ordinates.
    constexpr double many_turns = 150;
    const double optical_depth = scene_.medium.mu_t * scene_.domain.depth;
    if (std::abs(q) * std::min(4.0, optical_depth) > many_turns)
      add(found, folded((lights.first + lights.second) / 2),
          std::max(0.01, 1 / (std::abs(q) * std::min(1.0, optical_depth))));
    std::sort(found.begin(), found.end());
    found.erase(std::unique(found.begin(), found.end()), found.end());
    return found;
  }

 private:
  const Scene& scene_;
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

std::vector<Focus> light_foci(Pair lights, double width) {
  std::vector<Focus> found;
  for (const double angle : {lights.first, lights.second}) add(found, folded(angle), width);
  return found;
}

std::vector<Chain> chains(const CovarianceRequest& request, bool reversed, double shift) {
  std::vector<Chain> all;
  for (std::size_t e = 0; e < request.entries.size(); ++e) {
    const Entry entry = request.entries[e];
    const Channel a = request.channels[entry.a], b = request.channels[entry.b];
    const double i1 = request.lights[a.light].angle, v1 = request.views[a.view].angle,
                 i2 = request.lights[b.light].angle, v2 = matched_view(request, entry, shift);
    all.push_back({{i1, i2}, {v1, v2}, e});
    if (reversed) all.push_back({{i1, v2 + std::numbers::pi}, {v1, i2 + std::numbers::pi}, e});
  }
  return all;
}

std::vector<ChainGroup> grouped(const Scene& scene, const ScatteringLaw& law,
                                const std::vector<Chain>& chains, double shift) {
  constexpr double same_momentum = 1e-12;  // of k
  const double unit = same_momentum * scene.k / scene.medium.mu_t;
  const Foci foci(scene, chains, law.width());
  std::map<std::pair<double, std::vector<Focus>>, ChainGroup> groups;
  for (const Chain& chain : chains) {
    const double q = unit * std::round(transverse_momentum(scene, chain.lights, shift) / unit);
    const auto own = foci.of(chain.lights, q);
    ChainGroup& group = groups[{q, own}];
    group.q = q;
    group.foci = own;
    group.links.push_back(
        {number_of(group.lights, chain.lights), number_of(group.views, chain.views), chain.entry});
  }
  std::vector<ChainGroup> list;
  for (auto& [key, group] : groups) list.push_back(std::move(group));
  return list;
}

}  // namespace flatspeckle::mc
