#pragma once

#include <string>
#include <vector>

#include "core/result/dataset_row.h"
#include "flatland/request/request.h"
#include "wave_solver/clusters/cluster_equations.h"
#include "wave_solver/solutions/equation_solver.h"

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

/// The exact scattered field of copies of one cluster under unit plane waves.
class ClusterSolution {
 public:
  /// By the equations with T^-1, dense or fast; where T is too nearly singular for that, by a dense
  /// LU of 1 - T S. Throws as ClusterEquations and EquationSolver do, where fast is asked for then,
  /// and InputError for sensors that are closer to a cluster's circle than its gap.
  ClusterSolution(const ClusterTMatrix& cluster, std::vector<ClusterPlace> places,
                  std::vector<double> light_angles, const SolveOptions& options = {});

  const ClusterEquations& equations() const { return equations_; }
  const std::vector<ClusterPlace>& places() const { return places_; }
  const std::vector<double>& light_angles() const { return light_angles_; }
  const Diagnosis& diagnosis() const { return found_.diagnosis; }
  /// How the equations were solved, in words.
  const std::string& method() const { return found_.method; }
  /// For all lights: [light][view]; near ones are scattered fields.
  std::vector<Complex> fields(const std::vector<View>& views) const;

 private:
  std::vector<ClusterPlace> places_;
  std::vector<double> light_angles_;
  ClusterEquations equations_;
  LightSolution found_;
};

extern const DatasetTable cluster_solution_table;
/// As write_solution() of a placement does.
void write_solution(ResultFile& file, const ClusterSolution& solution,
                    const std::vector<double>& view_angles, const std::vector<Vec2>& sensors);

}  // namespace flatspeckle::wave
