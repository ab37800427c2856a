#pragma once

#include <vector>

#include "flatland/placement/placement.h"
#include "wave_solver/equations/cylinder_waves.h"
#include "wave_solver/equations/wave_equations.h"

namespace flatspeckle::wave {

/// T-matrix of a group of scatterers: maps regular cylindrical waves about the origin to outgoing
/// ones [waterman1969]. Amplitudes a of the regular and b of the outgoing waves (cylinder_waves.h)
/// are related by b/w = response (w a). w_n is the largest |J_m(k R)| with m >= n, so that
/// `response` has entries of moderate size. By reciprocity it is symmetric in these real waves.
struct ClusterTMatrix {
  double k = 0;
  double radius = 0;  ///< radius R of the circle about the origin that encloses the cluster
  /// Least distance of sources, sensors and circles of other clusters from this circle. It
  /// determines the order of the series.
  double gap = 0;
  int order = 0;
  std::vector<Mode> modes;        ///< order 0, cos(phi), sin(phi), .. up to `order`, weights w_n
  std::vector<Complex> response;  ///< matrix of size modes x modes, column-major

  /// Returns the response of the cluster rotated by an angle (C2) about its centre.
  std::vector<Complex> turned(double angle) const;
};

/// Computes the T-matrix of a placement about the origin: its equations are factored once, with all
/// incident orders as right-hand sides. For sources at least `gap` away from the circle, the
/// truncation error of the series is below the tolerance, because |J_n(k R) H_n(k (R + gap))| and
/// |J_n(k R)| are below the tolerance for all omitted n. Throws InputError if the gap is not
/// positive or requires too many orders, and under the conditions of TMatrixSystem.
ClusterTMatrix cluster_t_matrix(const Placement& cluster, double k, double gap,
                                double tolerance = 1e-12);

/// Returns a ClusterTMatrix whose modes are set but whose response is empty.
ClusterTMatrix cluster_waves(double k, double radius, double gap, int order);

/// Position of a copy of a cluster and the angle of its rotation (C2).
struct ClusterPlace {
  Vec centre;
  double angle = 0;
};

/// Inverse of a cluster's T-matrix T in waves scaled by sigma_n, where sigma_n^2 is about |T_nn|.
struct ScaledInverse {
  std::vector<double> sizes;     ///< sigma_n / w_n of each mode (w_n: ClusterTMatrix)
  std::vector<Complex> inverse;  ///< -sigma T^-1 sigma, column-major
  /// Relative error that rounding causes when T is inverted twice, in fields at least `gap` from
  /// the circle.
  double inversion_error = 0;
};
ScaledInverse scaled_inverse(const ClusterTMatrix& cluster);

/// The multiple-scattering equations of copies of one cluster. Each copy is a body with the
/// cluster's waves as unknowns.
class ClusterEquations : public WaveEquations {
 public:
  /// Throws InputError if the circles of two copies are closer to each other than the gap.
  ClusterEquations(const ClusterTMatrix& cluster, const std::vector<ClusterPlace>& places,
                   const ScaledInverse& inverse);
  /// For a T that is too close to singular to be inverted: creates equations without T^-1, whose
  /// matrix is only w S w.
  ClusterEquations(const ClusterTMatrix& cluster, const std::vector<ClusterPlace>& places);

  /// Whether the equations contain T^-1.
  bool have_inverse() const { return have_inverse_; }

 private:
  void add_copies(const ClusterTMatrix& own, const std::vector<ClusterPlace>& places);

  bool have_inverse_;
};

}  // namespace flatspeckle::wave
