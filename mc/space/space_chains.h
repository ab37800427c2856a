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

/// Ladders of all entries, and their reversed paths (C38). The wavenumber of the second field is
/// larger by a share `shift`; second views are turned so that transverse momenta match, which must
/// leave them above the horizon.
std::vector<SpaceChain> ladders(const SpaceRequest& request, double shift);
std::vector<SpaceChain> reversed_ladders(const SpaceRequest& request, double shift);

SpacePair turned_round(const SpacePair& pair);

/// Exponents of a pair along z; k: per mu_t. Of views: that of turned_round().
template <typename Number>
PairWaveOf<Number> pair_wave(double k, const SpacePair& pair, const Departure<Number>& departure) {
  return pair_wave(k, pair.first.z(), pair.second.z(), departure);
}

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

/// width: within which the phase function changes. shift: as of ladders().
std::vector<SpaceGroup> grouped(const std::vector<SpaceChain>& chains, double width, double shift);

}  // namespace flatspeckle::mc
