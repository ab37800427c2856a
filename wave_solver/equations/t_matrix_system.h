#pragma once

#include <span>
#include <vector>

#include "core/numbers/complex.h"
#include "core/numbers/scaled.h"
#include "flatland/placement/placement.h"
#include "wave_solver/equations/wave_equations.h"

namespace flatspeckle::wave {

/// What basis() chooses.
struct Basis {
  std::vector<std::vector<ScaledComplex>> t;  ///< of every scatterer: T_n, n = 0 .. its basis order
  bool gap_plasmons = false;  ///< a TE disk of Re(index^2) < 0 has a gap narrower than a radius
};

/// T_n of every scatterer for n = 0 .. its basis order, times growth.
///
/// The order is the one at which the pairs that a disk forms with the closest neighbours of every
/// kind (neighbours.h), each solved by itself, have converged: with beta_n its
/// coefficients under plane waves and F the root mean square of its amplitude sum T_n e^{in theta},
///   sum beta_n^2 + sum beta_n |T_n|^(1/2) |H_n(k r)| <= tolerance F / safety
/// over the orders left out; r is the distance of the nearest near-field sensor. A sensor on the
/// rim of a penetrable disk asks for the field inside too, sum beta_n |u_n| <= tolerance / safety
/// with the rim's u_n (rim_waves.h): what drives a disk from close by falls off half as fast as its
/// far field. Where that takes too many orders (nearly touching hard disks, whose images of each
/// other all add up), beta_n^2 is bounded by F |T_n| w_n^2: |H_n(k s)| is due to those images,
/// which accumulate at the distance s (nearest_image), and gives M >= ln(1/eps) / (2 xi) in
/// statics; between large disks |T_m H_{n+m}(k d)| max(1, |H_m(k s')|) of the neighbour's orders m
/// is more. Beside TE disks of Re(index^2) < 0, whose images are stronger than what causes them,
/// there is no such bound: what pairs do not tell is refused.
///
/// Throws InputError for scatterers without a T-matrix, and, naming the order that would be needed,
/// where it is above highest_order.
Basis basis(const Placement& placement, double k, double tolerance, std::span<const Vec2> sensors,
            double growth = 1);

/// Two disks of this order have 16,000 unknowns, a matrix of 4 GB.
inline constexpr int highest_order = 4000;

/// The multiple-scattering equations of one placement, with sigma_n = sqrt|T_n|: the diagonal is
/// -|T_n|/T_n, and 1 where T_n = 0. Entries are of moderate size however many orders T_n and S span
/// (C11).
class TMatrixSystem : public WaveEquations {
 public:
  /// Orders follow from the tolerance. sensors: where the near field will be wanted. growth: what
  /// orders are multiplied by. Throws InputError for scatterers without a T-matrix or disks too
  /// close to be resolved.
  TMatrixSystem(Placement placement, double k, double tolerance, std::span<const Vec2> sensors = {},
                double growth = 1);

  const Placement& placement() const { return placement_; }
  /// Whether narrow gaps beside TE disks of Re(index^2) < 0 may resonate, many of them together:
  /// orders that suffice for pairs are then confirmed by higher ones.
  bool has_gap_plasmons() const { return has_gap_plasmons_; }
  /// T_n for n = 0 .. order.
  std::span<const ExtendedComplex> t_matrix(std::size_t scatterer) const { return t_[scatterer]; }

  /// d ln T_n / d ln(radius) of each unknown, 0 for points.
  std::vector<Complex> radius_derivatives() const;

  /// -sigma a of a point source, the Green function (C3); by reciprocity -i/4 of outside_row().
  /// Throws InputError for a source inside a disk or on a point scatterer.
  std::vector<Complex> source_side(Vec2 source) const;

 private:
  Placement placement_;
  std::vector<std::vector<ExtendedComplex>> t_;
  bool has_gap_plasmons_ = false;
};

}  // namespace flatspeckle::wave
