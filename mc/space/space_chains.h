#pragma once

#include <vector>

#include <Eigen/Core>

#include "flatland/request/request.h"
#include "mc/transport/angular_grid.h"
#include "mc/transport/pair_wave.h"

namespace flatspeckle::mc {

/// Unit vectors, z into the slab: of two lights, or of two views. None along the slab.
struct SpacePair {
  Eigen::Vector3d first, second;
  bool operator==(const SpacePair&) const = default;
};

/// What a covariance in space is asked for: plane waves and far views by their directions, and
/// entries whose pairs of lights and views differ by the same transverse momentum (C18).
struct SpaceRequest {
  std::vector<Eigen::Vector3d> lights, views;
  std::vector<Channel> channels;
  std::vector<Entry> entries;
};

/// In the plane y = 0: of a request of far lights and views by their angles.
SpaceRequest space_request(const CovarianceRequest& plane);

/// Paths that add to an entry: a pair of lights, what it scatters into, and a pair of views.
struct SpaceChain {
  SpacePair lights, views;
  std::size_t entry;
};

/// Ladders of all entries, and with `reversed` their reversed paths (C38).
std::vector<SpaceChain> ladders(const SpaceRequest& request);
std::vector<SpaceChain> reversed_ladders(const SpaceRequest& request);

/// Of pairs of lights in units of k: difference of their directions along the slab.
Eigen::Vector2d transverse(const SpacePair& lights);

/// Exponents of a pair along z; k: per extinction coefficient. Of views: that of turned_round().
PairWave pair_wave(double k, const SpacePair& pair);
SpacePair turned_round(const SpacePair& pair);

/// Chains of one transverse momentum on one angular grid: pairs once, chains by their numbers.
struct SpaceGroup {
  Eigen::Vector2d momentum;  ///< in units of k
  std::vector<Focus> foci;
  std::vector<SpacePair> lights, views;
  struct Link {
    Eigen::Index light, view;
    std::size_t entry;
  };
  std::vector<Link> links;
};

/// width: within which the phase function changes.
std::vector<SpaceGroup> grouped(const std::vector<SpaceChain>& chains, double width);

}  // namespace flatspeckle::mc
