#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "core/result/dataset_row.h"
#include "flatland/media/domain.h"

namespace flatspeckle {

/// Theory of the equilibrium fluid of equal hard disks, for packing fractions from 0 to 0.7. The
/// Percus-Yevick equation has no closed solution in two dimensions; the direct correlation function
/// of Baus and Colot [baus1987], made consistent with Henderson's equation of state
/// [henderson1975], is used instead. Compared with simulations of 1000 disks (EventChains), the
/// error of the structure factor is 1 % at packing 0.3, 2.5 % at 0.5, 4.5 % at 0.6 and 10 % at
/// 0.65.
class HardDiskFluid {
 public:
  /// diameter: contact distance, which includes the gap between disks. packing: packing fraction of
  /// disks with this diameter.
  HardDiskFluid(double packing, double diameter);

  /// Returns the pair correlation function at contact, (Z - 1) / (2 eta), with Z = p / (rho k T) =
  /// (1 + eta^2/8) / (1 - eta)^2. This Z is 0.4 % too high at packing 0.5, and 2 % at 0.65.
  double contact_value() const;
  /// Returns S(q), q >= 0 in inverse lengths. S(0) = 1 / [d(eta Z) / d eta].
  double structure_factor(double q) const;

 private:
  double packing_, diameter_;
  double stiffness_;  ///< d(eta Z) / d eta = 1 / S(0)
  double scale_;      ///< length a of the overlap function, in diameters
};

/// Structure factor S(q) = |sum_j exp(i q.r_j)|^2 / N measured on placements and averaged over
/// shells of |q|. Only the wavevectors (2 pi n / width, 2 pi m / depth) that fit the box are used;
/// at other wavevectors the result would depend on the shape of the box. Standard errors follow
/// from the spread over realizations.
class MeasuredStructureFactor {
 public:
  /// Divides |q| up to q_max into shells of the given width. Shells that contain no wavevector are
  /// left out.
  MeasuredStructureFactor(const Domain& box, double q_max, double shell_width);

  /// Adds one realization, which must not be empty.
  void add(std::span<const Vec> centres);

  /// Returns the mean of f(|q|) over the wavevectors of each shell.
  std::vector<double> shell_means(const std::function<double(double)>& f) const;
  std::vector<double> values() const;
  /// Returns the standard errors; requires at least two realizations.
  std::vector<double> errors() const;

 private:
  struct Wavevector {
    std::size_t index;  ///< position in the result of density_waves()
    double q;
    std::size_t shell;
  };

  std::vector<double> density_waves(std::span<const Vec> centres) const;

  Domain box_;
  std::size_t most_n_, most_m_;
  std::vector<Wavevector> wavevectors_;
  std::uint64_t realizations_ = 0;
  // For each shell: number of wavevectors, mean, and sum of squared deviations from the mean.
  std::vector<double> members_, mean_, squares_;
};

extern const DatasetTable structure_factor_table;
/// Writes the structure factor against q. fluid: theory that is also written; nullptr for none.
void write_structure(ResultFile& file, const MeasuredStructureFactor& measured,
                     const HardDiskFluid* fluid);

}  // namespace flatspeckle
