#pragma once

#include <functional>
#include <vector>

#include "core/numbers/complex.h"

namespace flatspeckle::oracles {

/// The covariance of two fields behind an infinite slab without random numbers, for any phase
/// function and any tilt: C14 (F conj F, all B) and C18 as a transport equation. Both paths carry
/// one transverse momentum q = k (sin i1 - sin i2), so the mutual radiance exp(i q x) J(z, theta)
/// obeys
///   cos(theta) dJ/dz = -(mu_t + i q sin(theta)) J + mu_s int p(theta - theta') J(theta') dtheta'
/// and scatters into and out of pairs of directions by A A*. Solved by adding and doubling, like
/// SlabTransport, with complex rates of decay.
class PairTransport {
 public:
  struct Medium {
    double k, depth, mu_t, albedo;
    std::function<double(double)> phase;  ///< p(angle), even, integral 1 over 2 pi (C5)
  };
  /// Directions of two lights, or of the two transmitted views that go with them.
  struct Pair {
    double first, second;
  };
  /// All pairs must share one k (sin first - sin second). `panels` of 10 nodes per quadrant:
  /// forward peaks of width 1 - g want 0.8 / (1 - g) of them.
  PairTransport(const Medium& medium, const std::vector<Pair>& lights,
                const std::vector<Pair>& views, int panels);

  /// By the numbers of the pairs of lights and views; |angles| < pi/2.
  Complex covariance(std::size_t lights, std::size_t views) const;

 private:
  using Matrix = std::vector<Complex>;
  /// Of the slab and its parts, alike from above and below: [out][in], angles from -z where
  /// reflected.
  struct Layer {
    Matrix reflected, transmitted;
  };
  /// A node of the quadrature, where both angles are equal, or a pair, of weight 0.
  struct Ordinate {
    Pair angles;
    double weight, per_cosine;  ///< radiance per power
    Complex rate;               ///< of decay with optical depth
    double scale = 1;           ///< of the phase function, to conserve power
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
