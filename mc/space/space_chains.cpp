#include "mc/space/space_chains.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <tuple>

namespace flatspeckle::mc {

namespace {

template <typename Ends>
std::vector<SpaceChain> chains_of(const SpaceRequest& request, const Ends& ends) {
  std::vector<SpaceChain> all;
  for (std::size_t e = 0; e < request.entries.size(); ++e) {
    const Channel a = request.channels[request.entries[e].a],
                  b = request.channels[request.entries[e].b];
    all.push_back(ends(request.lights[a.light], request.views[a.view], request.lights[b.light],
                       request.views[b.view]));
    all.back().entry = e;
  }
  return all;
}

/// Its number in a list that it is in then.
Eigen::Index listed(std::vector<SpacePair>& list, const SpacePair& pair) {
  const auto found = std::find(list.begin(), list.end(), pair);
  if (found != list.end()) return found - list.begin();
  list.push_back(pair);
  return static_cast<Eigen::Index>(list.size()) - 1;
}

/// In steps of half a width, so that lights near to each other have one grid.
std::vector<Focus> space_foci(const SpacePair& lights, double width) {
  constexpr double too_wide = 0.4;  // for any panel to be split
  std::vector<Focus> found;
  if (width >= too_wide) return found;
  for (const auto& light : {lights.first, lights.second}) {
    const double angle = std::atan2(light.head<2>().norm(), std::abs(light.z()));
    found.push_back({width / 2 * std::round(angle / (width / 2)), width});
  }
  std::sort(found.begin(), found.end());
  found.erase(std::unique(found.begin(), found.end()), found.end());
  return found;
}

}  // namespace

SpaceRequest space_request(const CovarianceRequest& plane) {
  const auto direction = [](double angle) {
    return Eigen::Vector3d(std::sin(angle), 0, std::cos(angle));
  };
  SpaceRequest request{{}, {}, plane.channels, plane.entries};
  for (const Light& light : plane.lights) request.lights.push_back(direction(light.angle));
  for (const View& view : plane.views) request.views.push_back(direction(view.angle));
  return request;
}

std::vector<SpaceChain> ladders(const SpaceRequest& request) {
  return chains_of(request, [](const auto& i1, const auto& v1, const auto& i2, const auto& v2) {
    return SpaceChain{{i1, i2}, {v1, v2}, 0};
  });
}

std::vector<SpaceChain> reversed_ladders(const SpaceRequest& request) {
  return chains_of(request, [](const auto& i1, const auto& v1, const auto& i2, const auto& v2) {
    return SpaceChain{{i1, -v2}, {v1, -i2}, 0};
  });
}

Eigen::Vector2d transverse(const SpacePair& lights) {
  return (lights.first - lights.second).head<2>();
}

PairWave pair_wave(double k, const SpacePair& pair) {
  return pair_wave<double>(k, pair.first.z(), pair.second.z(), {});
}

SpacePair turned_round(const SpacePair& pair) {
  return {-pair.first, -pair.second};
}

std::vector<SpaceGroup> grouped(const std::vector<SpaceChain>& chains, double width) {
  constexpr double same_momentum = 1e-12;
  std::map<std::tuple<double, double, std::vector<Focus>>, SpaceGroup> groups;
  for (const SpaceChain& chain : chains) {
    const Eigen::Vector2d momentum =
        (transverse(chain.lights) / same_momentum).array().round() * same_momentum;
    const auto foci = space_foci(chain.lights, width);
    SpaceGroup& group = groups[{momentum.x(), momentum.y(), foci}];
    group.momentum = momentum;
    group.foci = foci;
    group.links.push_back(
        {listed(group.lights, chain.lights), listed(group.views, chain.views), chain.entry});
  }
  std::vector<SpaceGroup> list;
  for (auto& [key, group] : groups) list.push_back(std::move(group));
  return list;
}

}  // namespace flatspeckle::mc
