#include "mc/space/space_chains.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <tuple>

namespace flatspeckle::mc {

namespace {

/// The second view, turned.
Eigen::Vector3d matched(const SpacePair& lights, const SpacePair& views, double shift) {
  if (shift == 0) return views.second;
  const Eigen::Vector2d along =
      (lights.second - (lights.first - views.first) / (1 + shift)).head<2>();
  return {along.x(), along.y(),
          std::copysign(std::sqrt(1 - along.squaredNorm()), views.second.z())};
}

/// Of pairs of lights in units of k.
Eigen::Vector2d transverse(const SpacePair& lights, double shift) {
  return (lights.first - (1 + shift) * lights.second).head<2>();
}

template <typename Ends>
std::vector<SpaceChain> chains_of(const SpaceRequest& request, double shift, const Ends& ends) {
  std::vector<SpaceChain> all;
  for (std::size_t e = 0; e < request.entries.size(); ++e) {
    const Channel a = request.channels[request.entries[e].a],
                  b = request.channels[request.entries[e].b];
    const SpacePair lights{request.lights[a.light], request.lights[b.light]};
    SpacePair views{request.views[a.view], request.views[b.view]};
    views.second = matched(lights, views, shift);
    all.push_back(ends(lights, views));
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

std::vector<SpaceChain> ladders(const SpaceRequest& request, double shift) {
  return chains_of(request, shift, [](const SpacePair& lights, const SpacePair& views) {
    return SpaceChain{lights, views, 0};
  });
}

std::vector<SpaceChain> reversed_ladders(const SpaceRequest& request, double shift) {
  return chains_of(request, shift, [](const SpacePair& lights, const SpacePair& views) {
    return SpaceChain{{lights.first, -views.second}, {views.first, -lights.second}, 0};
  });
}

SpacePair turned_round(const SpacePair& pair) {
  return {-pair.first, -pair.second};
}

std::vector<SpaceGroup> grouped(const std::vector<SpaceChain>& chains, double width, double shift) {
  constexpr double same_momentum = 1e-12;
  std::map<std::tuple<double, double, std::vector<Focus>>, SpaceGroup> groups;
  for (const SpaceChain& chain : chains) {
    const Eigen::Vector2d momentum =
        (transverse(chain.lights, shift) / same_momentum).array().round() * same_momentum;
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
