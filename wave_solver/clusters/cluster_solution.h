#pragma once

#include <string>
#include <vector>

#include "core/result/dataset_row.h"
#include "flatland/request/request.h"
#include "wave_solver/clusters/cluster_equations.h"
#include "wave_solver/solutions/equation_solver.h"

namespace flatspeckle::wave {

/// A T-matrix as stored in a file, with its origin in the coordinates of the placement and its
/// accuracy.
struct KeptCluster {
  ClusterTMatrix t_matrix;
  Vec centre;  ///< centre of the enclosing circle, in the coordinates of the placement
  double tolerance = 0;
};

/// Computes the T-matrix of a placement about the centre of its enclosing circle. Throws under the
/// conditions of cluster_t_matrix().
KeptCluster kept_cluster(const Placement& placement, double k, double gap, double tolerance);

extern const DatasetTable cluster_table;
/// Writes T_mn of the waves e^{i n phi}, n = -order .. order (C6), to the HDF5 group `cluster`.
void write_cluster(ResultFile& file, const KeptCluster& cluster);
/// Reads a T-matrix. Throws InputError if the file contains none.
KeptCluster read_cluster(const std::string& path);

/// Reads the places of copies from a CSV file with columns x, z [, angle]. Throws InputError.
std::vector<ClusterPlace> read_places(const std::string& path);

/// The exact scattered field of copies of one cluster under unit plane waves.
class ClusterSolution {
 public:
  /// Solves the equations that contain T^-1 by the method of the options. If T is too close to
  /// singular, uses a dense LU of 1 - T S instead. Throws InputError if that LU is needed but the
  /// method is fast or krylov, or if a sensor is closer to a cluster's circle than the gap. Also
  /// throws under the conditions of ClusterEquations and EquationSolver.
  ClusterSolution(const ClusterTMatrix& cluster, std::vector<ClusterPlace> places,
                  std::vector<double> light_angles, const SolveOptions& options = {});

  const ClusterEquations& equations() const { return equations_; }
  const std::vector<ClusterPlace>& places() const { return places_; }
  const std::vector<double>& light_angles() const { return light_angles_; }
  const Diagnosis& diagnosis() const { return found_.diagnosis; }
  /// Description of the method that solved the equations.
  const std::string& method() const { return found_.method; }
  /// Returns the fields for all illuminations, [light][view]: far-field amplitudes, or scattered
  /// fields at near sensors.
  std::vector<Complex> fields(const std::vector<View>& views) const;

 private:
  std::vector<ClusterPlace> places_;
  std::vector<double> light_angles_;
  ClusterEquations equations_;
  LightSolution found_;
};

extern const DatasetTable cluster_solution_table;
/// Writes the same datasets as write_solution() of a WaveSolution, with the places of the copies
/// instead of the scatterers.
void write_solution(ResultFile& file, const ClusterSolution& solution,
                    const std::vector<double>& view_angles, const std::vector<Vec>& sensors);

}  // namespace flatspeckle::wave
