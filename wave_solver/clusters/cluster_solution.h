#pragma once

#include <vector>

#include "wave_solver/clusters/cluster_t_matrix.h"

namespace flatspeckle::wave {

/// Where a copy of a cluster stands: its centre, and how far it is turned (C2).
struct ClusterPlace {
  Vec2 centre;
  double angle = 0;
};

/// Far-field amplitudes (C4, phase origin r = 0), [light][view], of copies of one cluster under
/// unit plane waves: b = T (a + S b) of C10 with the clusters as objects. Throws InputError where
/// circles are closer than the cluster's gap, std::runtime_error where the equations are singular.
std::vector<Complex> cluster_far_fields(const ClusterTMatrix& cluster,
                                        const std::vector<ClusterPlace>& places,
                                        const std::vector<double>& light_angles,
                                        const std::vector<double>& view_angles);

}  // namespace flatspeckle::wave
