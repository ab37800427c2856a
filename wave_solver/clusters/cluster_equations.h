#pragma once

#include <vector>

#include "flatland/placement/placement.h"
#include "wave_solver/equations/cylinder_waves.h"
#include "wave_solver/equations/wave_equations.h"

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

/// Where a copy of a cluster stands: its centre, and how far it is turned (C2).
struct ClusterPlace {
  Vec2 centre;
  double angle = 0;
};

/// T of a cluster in waves whose sigma_n^2 is the size of T_nn.
struct ScaledInverse {
  std::vector<double> sizes;     ///< sigma_n / w_n
  std::vector<Complex> inverse;  ///< -sigma T^-1 sigma, column-major
  /// Of T by rounding, inverted back: relative, of fields from and to no closer than the gap.
  double lost = 0;
};
ScaledInverse scaled_inverse(const ClusterTMatrix& cluster);

/// The multiple-scattering equations of copies of one cluster, each a body with the cluster's waves
/// as unknowns.
class ClusterEquations : public WaveEquations {
 public:
  /// Throws InputError where circles are closer than the cluster's gap.
  ClusterEquations(const ClusterTMatrix& cluster, const std::vector<ClusterPlace>& places,
                   const ScaledInverse& inverse);
  /// With nothing but w S w, for a T that is too nearly singular to be inverted.
  ClusterEquations(const ClusterTMatrix& cluster, const std::vector<ClusterPlace>& places);

  /// Whether T^-1 is in them.
  bool are_whole() const { return whole_; }

 private:
  void add_copies(const ClusterTMatrix& own, const std::vector<ClusterPlace>& places);

  bool whole_;
};

}  // namespace flatspeckle::wave
