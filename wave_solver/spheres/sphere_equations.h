#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "core/numbers/complex.h"
#include "flatland/placement/placement.h"
#include "flatland/request/request.h"
#include "wave_solver/dense/dense_factor.h"
#include "wave_solver/equations/basis_orders.h"
#include "wave_solver/spheres/spherical_waves.h"

namespace flatspeckle::wave {

/// The multiple-scattering equations M beta = -sigma a of points and spheres in space (C61), with
///   M = -sigma T^-1 sigma + sigma S sigma,   sigma_l = sqrt|T_l|,   b = sigma beta.
/// In real harmonics M is complex symmetric. Its real part is positive semidefinite, as that of
/// WaveEquations. Unknowns run over scatterers and, within each, over harmonic_index().
class SphereEquations {
 public:
  /// Throws InputError for scatterers without a T-matrix.
  SphereEquations(Placement placement, double k, const Basis& basis);
  SphereEquations(SphereEquations&&) = default;

  double k() const { return k_; }
  const Placement& placement() const { return placement_; }
  std::size_t unknowns() const { return first_.back(); }
  /// Whether every scatterer has a single unknown.
  bool only_points() const { return unknowns() == placement_.size(); }
  /// Index of the first unknown of a scatterer; first(placement().size()) is unknowns().
  std::size_t first(std::size_t scatterer) const { return first_[scatterer]; }
  int order(std::size_t scatterer) const { return sets_[scatterer].order; }
  /// Waves of the unknowns of a scatterer; their weights are sigma.
  const SphereSet& waves(std::size_t scatterer) const { return sets_[scatterer]; }
  /// Returns |T_l| and T_l of an unknown.
  double strength(std::size_t unknown) const;
  ExtendedComplex t_matrix(std::size_t unknown) const { return t_[degree_[unknown]]; }
  Complex diagonal(std::size_t unknown) const { return diagonal_[unknown]; }

  /// Returns M, column by column. Threaded unless called from a parallel region. Throws InputError
  /// if memory does not suffice.
  Entries matrix() const;
  /// Returns M x for one or more columns x, both [column][unknown]; M is not stored. The cost is
  /// quadratic in the number of scatterers. Threaded unless called from a parallel region.
  std::vector<Complex> apply(std::span<const Complex> x) const;

  /// Returns the right-hand sides -sigma a of lights: [light][unknown]. tolerance: accuracy of
  /// beams. Throws InputError for a source inside a scatterer.
  std::vector<Complex> right_hand_sides(const Lights& lights, double tolerance) const;
  /// Returns the contribution of each unknown to the amplitude in far views (C56), or to the
  /// scattered field at near sensors, which must be outside all spheres: [view][unknown].
  std::vector<Complex> view_rows(std::span<const View> views) const;

 private:
  void point_columns(Complex* matrix) const;
  void sphere_columns(Complex* matrix) const;
  std::vector<Complex> apply_points(std::span<const Complex> x) const;
  std::vector<Complex> apply_spheres(std::span<const Complex> x) const;

  double k_;
  Placement placement_;
  PointArrays centres_;
  std::vector<std::size_t> first_;
  std::vector<SphereSet> sets_;
  std::vector<std::size_t> degree_;  // of each unknown, the index of its degree in the lists below
  std::vector<ExtendedComplex> t_;
  std::vector<long double> sigma_;
  std::vector<Complex> diagonal_;
};

}  // namespace flatspeckle::wave
