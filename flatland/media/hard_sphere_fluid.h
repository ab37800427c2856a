#pragma once

namespace flatspeckle {

/// Structure factor of the equilibrium fluid of equal hard spheres in space, by the exact solution
/// of the Percus-Yevick equation [wertheim1963, thiele1963, ashcroft1966]. The solution is an
/// approximation of the fluid: compared with the equation of state of Carnahan and Starling
/// [carnahan1969], S(0) is 2 % too small at packing 0.2, 4 % at 0.3 and 11 % at 0.49.
class HardSphereFluid {
 public:
  /// Largest packing fraction; the fluid freezes at 0.494.
  static constexpr double most_packing = 0.49;

  /// diameter: contact distance of two centres. packing: fraction of the volume that spheres of
  /// this diameter fill, from 0 to most_packing.
  HardSphereFluid(double packing, double diameter);

  /// Returns S(q), q >= 0 in inverse lengths. S(0) = (1 - eta)^4 / (1 + 2 eta)^2, with eta the
  /// packing fraction.
  double structure_factor(double q) const;

 private:
  double packing_, diameter_;
  /// Coefficients of the direct correlation function c(r) = -(constant_ + linear_ r + cubic_ r^3)
  /// for r < 1, with r in diameters; c(r) = 0 beyond.
  double constant_, linear_, cubic_;
};

}  // namespace flatspeckle
