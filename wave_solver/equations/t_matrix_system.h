#pragma once

#include <span>
#include <vector>

#include "core/numbers/complex.h"
#include "flatland/placement/placement.h"
#include "wave_solver/dense/entries.h"
#include "wave_solver/equations/cylinder_waves.h"

namespace flatspeckle::wave {

/// The multiple-scattering equations of one placement (C10) in the real standing waves of
/// cylinder_waves.h, with b = sigma beta, sigma_n = sqrt|T_n|:
///   M beta = -sigma a,   M = diag(-|T_n|/T_n) + sigma S sigma  (diagonal 1 where T_n = 0).
/// Entries are of moderate size however many orders T_n and S span (C11), and M is complex
/// symmetric. No scatterer amplifies, -Re 1/T_n >= 1, and Re S + 1 is a Gram matrix of waves, so
/// the real part of M is positive semidefinite; Schur complements and real congruences keep that.
///
/// Unknowns run over scatterers and, within each, over 0, cos 1, sin 1, cos 2, sin 2, .. order.
class TMatrixSystem {
 public:
  /// Orders follow from the tolerance (basis_order.h). sensors: where the near field will be
  /// wanted. Throws InputError for scatterers without a T-matrix or disks too close to be resolved.
  TMatrixSystem(Placement placement, double k, double tolerance,
                std::span<const Vec2> sensors = {});

  const Placement& placement() const { return placement_; }
  double k() const { return k_; }
  std::size_t unknowns() const { return first_.back(); }
  int order(std::size_t scatterer) const { return static_cast<int>(t_[scatterer].size()) - 1; }
  /// First unknown of a scatterer; first(placement().size()) is unknowns().
  std::size_t first(std::size_t scatterer) const { return first_[scatterer]; }
  std::size_t scatterer_of(std::size_t unknown) const { return scatterer_[unknown]; }
  /// T_n for n = 0 .. order.
  std::span<const ExtendedComplex> t_matrix(std::size_t scatterer) const { return t_[scatterer]; }
  /// sigma psi of each unknown of a scatterer.
  ModeSet modes(std::size_t scatterer) const;

  Complex diagonal(std::size_t unknown) const { return diagonal_[unknown]; }
  /// M(rows, columns) into out[i + ld * j], for unknowns listed so that those of one scatterer
  /// stand side by side.
  void entries(std::span<const std::size_t> rows, std::span<const std::size_t> columns,
               Complex* out, std::size_t ld) const;
  /// Field at points of sigma psi of each column's unknown, into out[i + ld * j]. The points must
  /// lie off the scatterers concerned.
  void outgoing(std::span<const Vec2> points, std::span<const std::size_t> columns, Complex* out,
                std::size_t ld) const;

  /// M, column by column. Threaded unless called from a parallel region.
  Entries matrix() const;
  /// M x formed a block of columns at a time: [column][unknown].
  std::vector<Complex> apply(std::span<const Complex> x) const;

  /// -sigma a of unit plane waves (C6): [light][unknown].
  std::vector<Complex> right_sides(std::span<const double> light_angles) const;
  /// The same of a point source, the Green function (C3); by reciprocity -i/4 of near_row().
  std::vector<Complex> source_side(Vec2 source) const;
  /// What each unknown adds to the far-field amplitude at an angle (C6). By reciprocity a multiple
  /// of the right side of the light that comes from there.
  std::vector<Complex> far_row(double view_angle) const;
  /// What each unknown adds to the scattered field at a point. Throws InputError for a point inside
  /// a disk or on a point scatterer.
  std::vector<Complex> near_row(Vec2 point) const;

 private:
  struct Listed;
  std::vector<ModeSet> all_modes() const;
  std::vector<std::size_t> column_blocks() const;
  // M, in parts of columns with what is symmetric to them.
  void point_columns(Complex* matrix) const;
  void multipole_columns(Complex* matrix) const;
  void plane_wave(Vec2 w, Complex factor, std::span<Complex> column) const;

  Placement placement_;
  double k_;
  std::vector<std::size_t> first_, scatterer_;
  std::vector<std::vector<ExtendedComplex>> t_;
  std::vector<Mode> modes_;
  std::vector<Complex> diagonal_;
};

}  // namespace flatspeckle::wave
