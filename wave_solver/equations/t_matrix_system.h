#pragma once

#include <span>
#include <vector>

#include "core/numbers/complex.h"
#include "core/numbers/scaled.h"
#include "flatland/placement/placement.h"
#include "wave_solver/equations/wave_equations.h"

namespace flatspeckle::wave {

/// T-matrices [waterman1969], [martin2006], [thierry2015] of all scatterers, up to the basis orders
/// (highest angular orders that are kept) that basis() chose.
struct Basis {
  std::vector<std::vector<ScaledComplex>> t;  ///< [scatterer]: T_n for n = 0 .. basis order
  /// Whether a TE disk with Re(index^2) < 0 has a gap narrower than a radius.
  bool gap_plasmons = false;
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
/// Throws InputError for scatterers without a T-matrix, and if an order above highest_order would
/// be needed; the message contains that order.
Basis basis(const Placement& placement, double k, double tolerance, std::span<const Vec> sensors,
            double growth = 1);

/// Largest basis order. Two disks of this order have 16,000 unknowns and a matrix of 4 GB.
inline constexpr int highest_order = 4000;

/// The multiple-scattering equations M beta = -sigma a (WaveEquations) of one placement, with
/// sigma_n = sqrt|T_n|. The diagonal of M is -|T_n|/T_n, or 1 if T_n = 0. Entries of M are of
/// moderate size, although T_n and S span many orders of magnitude (C11).
class TMatrixSystem : public WaveEquations {
 public:
  /// Basis orders follow from the tolerance (basis()). sensors: points at which the near field will
  /// be evaluated. growth: factor by which the orders are increased. Throws InputError for
  /// scatterers without a T-matrix and for disks too close to be resolved.
  TMatrixSystem(Placement placement, double k, double tolerance, std::span<const Vec> sensors = {},
                double growth = 1);

  const Placement& placement() const { return placement_; }
  /// Whether narrow gaps next to TE disks with Re(index^2) < 0 may resonate collectively. If so,
  /// orders that suffice for pairs may be too low, and must be confirmed by a solution with higher
  /// orders.
  bool has_gap_plasmons() const { return has_gap_plasmons_; }
  /// T_n for n = 0 .. order.
  std::span<const ExtendedComplex> t_matrix(std::size_t scatterer) const { return t_[scatterer]; }

  /// Returns d ln T_n / d ln(radius) of each unknown, 0 for points.
  std::vector<Complex> radius_derivatives() const;

  /// Returns the right-hand side -sigma a for a point source, whose field is the Green function
  /// (C3). By reciprocity it is -i/4 times outside_row(). Throws InputError for a source inside a
  /// disk or on a point scatterer.
  std::vector<Complex> source_right_hand_side(Vec source) const;

 private:
  Placement placement_;
  std::vector<std::vector<ExtendedComplex>> t_;
  bool has_gap_plasmons_ = false;
};

}  // namespace flatspeckle::wave
