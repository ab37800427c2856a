#pragma once

#include <string>
#include <utility>
#include <vector>

#include "core/numbers/complex.h"
#include "flatland/scatterers/bulk_phase.h"
#include "flatland/scatterers/scatterer.h"

namespace flatspeckle {

/// S(q) of the positions in a medium (C16): a table over q in inverse lengths, linear between its
/// nodes, constant below the first, 1 above the last. Without nodes: independent positions, S = 1.
class StructureTable {
 public:
  StructureTable() = default;
  /// q rises; no value is negative. origin: in words, for plans.
  StructureTable(std::string origin, std::vector<double> q, std::vector<double> values);

  bool independent() const { return q_.empty(); }
  const std::string& origin() const { return origin_; }
  double operator()(double q) const;
  /// Every node, exactly: tells one table from another.
  std::string text() const;

 private:
  std::string origin_;
  std::vector<double> q_, values_;
};

/// Number per area and least distance between the centres of equal disks.
struct DiskSpacing {
  double density = 0, contact = 0;

  /// Counts the contact diameters, so with half the gap around each disk.
  double packing() const;
};

/// The equilibrium fluid of hard disks (HardDiskFluid), for momentum transfers up to q_max. Throws
/// InputError above packing 0.7.
StructureTable hard_disk_structure(const DiskSpacing& disks, double q_max);

/// structure_factor over q of a file that `place --structure` wrote. Throws InputError where it was
/// measured on disks of another density or contact distance (differences up to 2 % pass: numbers
/// of disks are whole), or where a value is not positive.
StructureTable read_structure(const std::string& path, const DiskSpacing& disks);

/// Bulk optical properties (C5). Lengths in the scene's unit. Where positions are correlated (C16),
/// those of the medium in which each scatterer has the amplitude A sqrt(S).
struct BulkMedium {
  int dimension = 2;  ///< 3: of space, for scalar waves (C41)
  double mu_s = 0, mu_t = 0;
  double g = 0, albedo = 1;
  double k_shift = 0;           ///< Re k_eff - k (C15); not defined (0) for the bulk
  bool has_scatterers = false;  ///< what follows exists: false for the bulk
  double density = 0;           ///< scatterers per area
  double packing_fraction = 0;
  CrossSections cross_sections;  ///< of one scatterer alone, like its T-matrix
  std::vector<ExtendedComplex> t_matrix;
  StructureTable structure;
  BulkPhase phase;         ///< empty but for Scatterer::Kind::other_bulk
  SpacePhase space_phase;  ///< empty in the plane

  double mean_free_path() const { return 1 / mu_t; }
  double transport_mean_free_path() const { return 1 / (mu_t - mu_s * g); }
};

/// Whether its coefficients are finite and scattering is at most extinction, up to rounding.
bool is_physical(const BulkMedium& medium);

/// A medium of scatterers with a T-matrix, at a number per area.
BulkMedium bulk_medium(const Scatterer& scatterer, double k, double density);
/// Gives a medium of scatterers another number per area.
void set_density(BulkMedium& medium, const Scatterer& scatterer, double k, double density);
/// A medium of given extinction that has a phase function.
BulkMedium bulk_medium(const Scatterer& bulk, const BulkPhase& phase, double mu_t);

/// The same scatterers at positions with a structure factor (C16): mu_s = rho int |A|^2 S, g and
/// albedo are those of |A|^2 S, absorption stays rho (sigma_e - sigma_s).
BulkMedium correlated_medium(BulkMedium independent, double k, StructureTable structure);

/// Bulks and how much of the domain each fills, in the mean.
BulkMedium mean_medium(const std::vector<std::pair<const BulkMedium*, double>>& shares);

/// A(theta) sqrt(S(2 k |sin(theta/2)|)) at theta = 0 .. pi in equal intervals, over the square root
/// of mu_s / rho: the absolute square is the phase function, up to a factor of order 1. The product
/// of two channels' amplitudes carries sqrt(S(q1) S(q2)), and a covariance stays positive
/// semidefinite (C16). The medium scatters.
std::vector<Complex> normalised_amplitudes(const BulkMedium& medium, double k,
                                           std::size_t intervals);

}  // namespace flatspeckle
