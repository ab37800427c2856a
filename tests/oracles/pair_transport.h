#pragma once

#include <functional>
#include <vector>

#include "core/numbers/complex.h"

namespace flatspeckle::oracles {

/// Computes the covariance of two fields behind an infinite slab deterministically, for any phase
/// function and any tilt. C14 (F conj F, all B) and C18 are solved as a transport equation. The
/// pair of paths has one transverse momentum q = k (sin i1 - sin i2), so the mutual radiance exp(i
/// q x) J(z, theta) obeys
///   cos(theta) dJ/dz = -(mu_t + i q sin(theta)) J + mu_s int p(theta - theta') J(theta') dtheta'
/// and pairs of directions scatter into each other with A A*. The equation is solved by adding and
/// doubling, as in SlabTransport, with complex decay rates.
class PairTransport {
 public:
  struct Medium {
    double k, depth, mu_t, albedo;
    std::function<double(double)> phase;  ///< p(angle), even, integral 1 over 2 pi (C5)
  };
  /// Directions of two illuminations, or of the two transmitted detection directions that belong to
  /// them.
  struct Pair {
    double first, second;
  };
  /// All pairs must have the same k (sin first - sin second). `panels` of 10 nodes per quadrant:
  /// forward peaks of width 1 - g require 0.8 / (1 - g) panels.
  PairTransport(const Medium& medium, const std::vector<Pair>& lights,
                const std::vector<Pair>& views, int panels);

  /// Returns the covariance for a pair of illuminations and a pair of detection directions, given
  /// by their indices. All angles must satisfy |angle| < pi/2.
  Complex covariance(std::size_t lights, std::size_t views) const;

 private:
  using Matrix = std::vector<Complex>;
  /// Response [out][in] of the slab or a part of it, which is the same for light from above and
  /// from below. Angles of reflected light are measured from -z.
  struct Layer {
    Matrix reflected, transmitted;
  };
  /// A node of the quadrature, whose two angles are equal, or a requested pair of directions, whose
  /// weight is 0.
  struct Ordinate {
    Pair angles;
    double weight, per_cosine;  ///< factor from power to radiance
    Complex rate;               ///< decay rate with optical depth
    double scale = 1;           ///< factor on the phase function that conserves power
  };
  void add_nodes(double q, int panels);
  void add_pair(Pair angles);
  void scale_phase();
  double phase_element(std::size_t out, std::size_t in, bool backward) const;
  Layer thin_layer(double optical_depth) const;
  Layer doubled(const Layer& half, double optical_depth) const;
  Matrix weighted(const Matrix& a) const;
  Matrix product(const Matrix& a, const Matrix& b) const;
  Matrix solve_one_minus(Matrix a, Matrix b) const;

  Medium medium_;
  std::size_t nodes_ = 0, lights_ = 0;
  std::vector<Ordinate> ordinates_;  ///< nodes, pairs of lights, pairs of views
  Layer slab_;
};

}  // namespace flatspeckle::oracles
