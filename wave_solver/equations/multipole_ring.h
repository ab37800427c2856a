#pragma once

#include <vector>

#include "wave_solver/equations/cylinder_waves.h"

namespace flatspeckle::wave {

/// Equally spaced point sources on a circle that radiate as the outgoing modes of one scatterer do,
/// beyond a stated distance. By Graf's theorem charges {cos, sin}(n phi) / (Q J_n(k rho)) radiate
/// H_n {cos, sin}(n phi) and orders beyond Q - n, which have died out there. By reciprocity the
/// transposed matrix takes the field on the ring to the coefficients of regular modes.
struct MultipoleRing {
  /// modes: with their weights. radius: of the disk that they belong to, 0 for a point.
  /// distance: nearest point of any other ring from the centre; errors there are below `tolerance`.
  MultipoleRing(const ModeSet& modes, double k, double radius, double distance, double tolerance);

  double radius = 0;             ///< of the ring, between half the disk's and all of it
  std::size_t points = 1;        ///< Q; 0 where no ring will do
  std::vector<Complex> charges;  ///< [mode][point]; real
  double largest_charge = 0;     ///< of the modes, summed over the points; infinite without points

  Vec2 position(std::size_t point) const;  ///< relative to the centre
};

}  // namespace flatspeckle::wave
