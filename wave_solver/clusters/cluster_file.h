#pragma once

#include <string>
#include <vector>

#include "core/result/dataset_row.h"
#include "wave_solver/clusters/cluster_equations.h"

namespace flatspeckle::wave {

/// A T-matrix as it is kept: from which placement's coordinates, and how exact.
struct KeptCluster {
  ClusterTMatrix t_matrix;
  Vec2 centre;  ///< of its circle, where the placement was
  double tolerance = 0;
};

/// T-matrix of a placement about the centre of a circle that holds it. Throws as
/// cluster_t_matrix().
KeptCluster kept_cluster(const Placement& placement, double k, double gap, double tolerance);

extern const DatasetTable cluster_table;
/// T_mn of the waves e^{i n phi}, n = -order .. order (C6), in the group cluster.
void write_cluster(ResultFile& file, const KeptCluster& cluster);
/// Throws InputError for a file that holds none.
KeptCluster read_cluster(const std::string& path);

/// Reads columns x, z [, angle]. Throws InputError.
std::vector<ClusterPlace> read_places(const std::string& path);

}  // namespace flatspeckle::wave
