#pragma once

#include <memory>
#include <span>
#include <vector>

#include "core/numbers/bessel.h"
#include "core/numbers/scaled.h"
#include "flatland/placement/placement.h"

namespace flatspeckle::wave {

/// T-matrices [waterman1969], [martin2006], [thierry2015] of all scatterers, up to the basis orders
/// (highest angular orders that are kept) that basis() chose.
struct Basis {
  std::vector<std::vector<ScaledComplex>> t;  ///< [scatterer]: T_n for n = 0 .. basis order
  /// Whether a TE disk with Re(index^2) < 0 has a gap narrower than a radius.
  bool gap_plasmons = false;
};

/// Rules that differ between cylinders and spheres.
struct OrderRules {
  Radial kind = Radial::cylindrical;
  int highest = 0;  ///< largest order that is accepted
  /// Solves the equations of an isolated pair under plane waves. Returns, for each order n of the
  /// first scatterer, the largest coefficient |beta_n| over the directions of the light, or an
  /// empty result if no solution is found. Arguments: T_n of both scatterers, k, and their
  /// distance.
  std::vector<double> (*pair_response)(const std::vector<ScaledComplex>& t_first,
                                       const std::vector<ScaledComplex>& t_second, double k,
                                       double distance) = nullptr;
};

/// Chooses the basis order of every scatterer, that is the highest angular order that is kept, and
/// returns its T_n for n = 0 .. growth times this order.
///
/// A disk is paired with its closest neighbour of every kind (neighbours.h), and each pair is
/// solved in isolation. The basis order is the lowest one that is sufficient for all of these
/// pairs. Let beta_n be the coefficients of the disk in its pair under plane waves, F the root mean
/// square of its amplitude sum T_n e^{in theta}, and r the distance of the nearest near-field
/// sensor. An order is sufficient if the sums over the omitted n satisfy
///   sum beta_n^2 + sum beta_n |T_n|^(1/2) |H_n(k r)| <= tolerance F / safety.
/// If a sensor is on the rim of a penetrable disk, the field inside must be accurate as well:
///   sum beta_n |u_n| <= tolerance / safety,   u_n: field at the rim (rim_waves.h).
/// The first power of beta_n appears because fields close to a disk decay half as fast with n as
/// its far field.
///
/// If a pair would have to be solved with too many orders (nearly touching hard disks, whose mutual
/// images all add up), beta_n^2 is replaced by its bound F |T_n| w_n^2. w_n is the largest of 1,
/// |H_n(k s)| and |T_m H_{n+m}(k d)| max(1, |H_m(k s')|) over the orders m of the neighbour. d is
/// the distance of the centres; s is nearest_image() of the disk and its neighbour, and s' that of
/// the neighbour and the disk. In statics the term with s gives the order ln(1/tolerance) / (2 xi),
/// xi as in nearest_image(). Between large disks the term with d is larger.
///
/// No such bound exists next to TE disks with Re(index^2) < 0, whose images are stronger than their
/// sources. Placements with such disks are rejected if the solutions of pairs do not converge with
/// the order.
///
/// For spheres the same holds with T_l, h_l and beta_l of the wave that the pair responds to most
/// strongly, F^2 = sum (2 l + 1) |T_l|^2, and beta_l divided by sqrt(4 pi).
///
/// Throws InputError for scatterers without a T-matrix, and if an order above OrderRules::highest
/// would be needed; the message contains that order. Solutions of pairs are kept, so that one
/// object serves many placements.
class BasisOrders {
 public:
  BasisOrders(double k, double tolerance, const OrderRules& rules);
  ~BasisOrders();

  Basis basis(const Placement& placement, std::span<const Vec> sensors, double growth = 1);

 private:
  class Search;
  std::unique_ptr<Search> search_;
};

}  // namespace flatspeckle::wave
