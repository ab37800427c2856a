#pragma once

#include <vector>

#include "wave_solver/clusters/cluster_t_matrix.h"
#include "wave_solver/equations/wave_equations.h"

namespace flatspeckle::wave {

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
