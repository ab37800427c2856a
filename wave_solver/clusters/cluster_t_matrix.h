#pragma once

#include <vector>

#include "flatland/placement/placement.h"
#include "wave_solver/equations/cylinder_waves.h"

namespace flatspeckle::wave {

/// A group of scatterers as one object: what it makes of regular cylindrical waves about the
/// origin, in outgoing ones (Waterman 1969). Unit waves are those of cylinder_waves.h times w_n,
/// the largest |J_m(k R)| of m >= n: the matrix b/w = response (w a) then has entries of moderate
/// size. In these real waves reciprocity makes it symmetric.
struct ClusterTMatrix {
  double k = 0;
  double radius = 0;  ///< R, of the circle about the origin that holds the cluster
  double gap = 0;     ///< of empty space around that circle, for which the order suffices
  int order = 0;
  std::vector<Mode> modes;        ///< 0, cos 1, sin 1, .. order, weighted by w_n
  std::vector<Complex> response;  ///< column-major, modes x modes

  ModeSet modes_at(Vec2 centre) const { return {centre, modes, order}; }
  /// The response of the cluster turned by an angle (C2) about its centre.
  std::vector<Complex> turned(double angle) const;
};

/// The T-matrix of a placement about the origin: its equations are factored once, with all incident
/// orders as right sides. What is left out of the series is below the tolerance, relative to
/// sources no closer than gap to the circle: |J_n(k R) H_n(k (R + gap))| and |J_n(k R)| of all n
/// beyond. Throws InputError for a gap that is not positive and where that takes too many orders,
/// and as TMatrixSystem does.
ClusterTMatrix cluster_t_matrix(const Placement& cluster, double k, double gap,
                                double tolerance = 1e-12);

/// The waves of a T-matrix, without its response.
ClusterTMatrix cluster_waves(double k, double radius, double gap, int order);

}  // namespace flatspeckle::wave
