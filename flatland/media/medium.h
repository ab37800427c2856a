#pragma once

#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "core/numbers/complex.h"
#include "flatland/scatterers/bulk_phase.h"
#include "flatland/scatterers/scatterer.h"

namespace flatspeckle {

/// Structure factor S(q) of the scatterers' positions (C16), q in inverse lengths. By default
/// positions are independent, S = 1.
class StructureFactor {
 public:
  StructureFactor() = default;
  /// Makes a table. S is linear between nodes, constant below the first node, and 1 above the last.
  /// q must be increasing and no value may be negative. origin: description of the source of the
  /// table, printed in the plan of a run.
  StructureFactor(std::string origin, std::vector<double> q, std::vector<double> values);
  /// Makes a structure factor with a closed form, which `origin` must identify completely.
  StructureFactor(std::string origin, std::function<double(double q)> formula);

  bool independent() const { return q_.empty() && !formula_; }
  const std::string& origin() const { return origin_; }
  double operator()(double q) const;
  /// Returns all nodes in full precision, or the origin of a closed form. Two structure factors
  /// have the same text only if they are equal.
  std::string text() const;

 private:
  std::string origin_;
  std::function<double(double)> formula_;
  std::vector<double> q_, values_;
};

/// Density and spacing of equal disks: their number per area, and the least distance between two
/// centres (contact).
struct DiskSpacing {
  double density = 0, contact = 0;

  /// Returns the packing fraction of disks with the contact distance as diameter, each of which
  /// includes half the gap around it.
  double packing() const;
};

/// Returns the structure factor of the equilibrium fluid of hard disks (HardDiskFluid), for
/// momentum transfers up to q_max. Throws InputError above packing 0.7.
StructureFactor hard_disk_structure(const DiskSpacing& disks, double q_max);

/// Returns the structure factor of the equilibrium fluid of hard spheres (HardSphereFluid).
/// density: number of spheres per volume. Throws InputError above HardSphereFluid::most_packing.
StructureFactor hard_sphere_structure(double density, double diameter);

/// Reads structure_factor against q from a file that `place --structure` wrote. Throws InputError
/// if it was measured on disks of another density or contact distance (differences up to 2 % are
/// accepted, because the number of disks is an integer), or if a value is not positive.
StructureFactor read_structure(const std::string& path, const DiskSpacing& disks);

/// Bulk optical properties (C5) in the scene's unit of length. For correlated positions (C16) they
/// are the properties of a medium in which each scatterer has the amplitude A sqrt(S).
struct BulkMedium {
  int dimension = 2;  ///< 2, or 3 for scalar waves in space (C41)
  double mu_s = 0, mu_t = 0;
  double g = 0, albedo = 1;
  double k_shift = 0;  ///< Re k_eff - k (C15); 0 without scatterers
  /// Whether the medium consists of scatterers with a T-matrix. Otherwise it has a phase function,
  /// and of the members from `density` to `structure` at most those of spheres of scatterer = mie
  /// are set, which are all but the T-matrix.
  bool has_scatterers = false;
  double density = 0;            ///< number of scatterers per area, in space per volume
  double packing_fraction = 0;   ///< fraction of the area, in space of the volume, that they fill
  CrossSections cross_sections;  ///< cross-sections of one isolated scatterer
  std::vector<ExtendedComplex> t_matrix;  ///< T_n of one isolated scatterer
  StructureFactor structure;
  BulkPhase phase;         ///< phase function; empty except for Scatterer::Kind::other_bulk
  SpacePhase space_phase;  ///< phase function in three dimensions; empty in two

  double mean_free_path() const { return 1 / mu_t; }
  double transport_mean_free_path() const { return 1 / (mu_t - mu_s * g); }
  double reduced_scattering() const { return mu_s * (1 - g); }
};

/// Whether the coefficients are finite and scattering does not exceed extinction, up to rounding.
bool is_physical(const BulkMedium& medium);

/// Returns a medium of scatterers that have a T-matrix. density: number of scatterers per area, in
/// space per volume. The phase function in space is not set.
BulkMedium bulk_medium(const Scatterer& scatterer, double k, double density, int dimension = 2);
/// Sets the number of scatterers per area or volume of a medium, and the properties that depend on
/// that number.
void set_density(BulkMedium& medium, const Scatterer& scatterer, double k, double density);
/// Returns a medium given by a phase function and an extinction coefficient.
BulkMedium bulk_medium(const Scatterer& bulk, const BulkPhase& phase, double mu_t);

/// Returns the amplitudes A(theta) sqrt(S(2 k sin(theta/2))) of a medium in space at theta = 0 ..
/// pi in equal intervals. Precondition: the scatterers have a T-matrix.
std::vector<Complex> correlated_amplitudes_in_space(const BulkMedium& medium, double k);

/// Returns the medium of the same scatterers at positions with the given structure factor (C16).
/// Then mu_s = rho int |A|^2 S, g and albedo follow from |A|^2 S, and the absorption remains rho
/// (sigma_e - sigma_s). The phase function in space is not set.
BulkMedium correlated_medium(BulkMedium independent, double k, StructureFactor structure);

/// Returns the mean of media, weighted by the fraction of the domain that each fills.
BulkMedium mean_medium(const std::vector<std::pair<const BulkMedium*, double>>& shares);

/// Returns the amplitudes A(theta) sqrt(S(2 k |sin(theta/2)|)) / sqrt(mu_s / rho) at theta = 0 ..
/// pi in equal intervals. Their absolute square is the phase function, up to a factor of order 1.
/// The product of the amplitudes of two channels contains sqrt(S(q1) S(q2)), so that a covariance
/// remains positive semidefinite (C16). Precondition: the medium scatters.
std::vector<Complex> normalised_amplitudes(const BulkMedium& medium, double k,
                                           std::size_t intervals);

}  // namespace flatspeckle
