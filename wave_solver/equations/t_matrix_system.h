#pragma once

#include <span>
#include <vector>

#include "core/numbers/complex.h"
#include "core/numbers/scaled.h"
#include "flatland/placement/placement.h"
#include "wave_solver/equations/basis_orders.h"
#include "wave_solver/equations/wave_equations.h"

namespace flatspeckle::wave {

/// Returns BasisOrders::basis() of cylinders.
Basis basis(const Placement& placement, double k, double tolerance, std::span<const Vec> sensors,
            double growth = 1);

/// Returns the placement, followed by its copies -1, 1, -2, 2, .. (Copies).
Placement with_copies(const Placement& placement, const Copies& copies);

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
                double growth = 1, const Copies& copies = {});

  /// Returns the same system with the copies as additional scatterers, in the order of
  /// with_copies().
  TMatrixSystem with_explicit_copies() const;

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
  explicit TMatrixSystem(double k) : WaveEquations(k) {}

  Placement placement_;
  std::vector<std::vector<ExtendedComplex>> t_;
  bool has_gap_plasmons_ = false;
};

}  // namespace flatspeckle::wave
