#pragma once

#include <span>
#include <vector>

#include "core/numbers/complex.h"
#include "flatland/media/domain.h"
#include "wave_solver/equations/cylinder_waves.h"
#include "wave_solver/spheres/harmonics.h"

namespace flatspeckle::wave {

/// Spherical waves about a centre, of all degrees l up to an order: weight_l h_l(k r) R_lm, or the
/// corresponding regular waves with j_l, with the real harmonics of harmonics.h (C60). They are
/// numbered by harmonic_index().
struct SphereSet {
  Vec centre;
  int order = 0;
  std::span<const long double> weight;  ///< weight of degree l = 0 .. order
};

/// Computes the coefficients of the regular waves about each receiver for unit outgoing waves of
/// the sender (C61). Rows are the waves of all receivers, one receiver after the other; columns are
/// the waves of the sender. A receiver at the position of the sender receives 0. Computed in double
/// precision, vectorised over receivers, or in long double where h_L would overflow.
void translate(double k, std::span<const SphereSet> receivers, const SphereSet& sender, Target out);

/// Evaluates the sender's outgoing waves at points. Rows are points, columns are waves.
void field_at(double k, std::span<const Vec> points, const SphereSet& sender, Target out);

/// Expands `factor` times the plane wave along the unit vector w in regular waves of the receivers
/// (C60): 4 pi i^l R_lm(w) e^{i k w.r}. The coefficients of one receiver after the other are added
/// to `out`.
void add_plane_wave(double k, std::span<const SphereSet> receivers, Vec w, Complex factor,
                    std::span<Complex> out);

/// Positions as separate arrays, for loops over many of them.
struct PointArrays {
  std::vector<double> x, y, z;

  void add(Vec point);
  std::size_t size() const { return x.size(); }
};

/// Computes h_0(k r) for the distances r of points begin .. begin + re.size() - 1 from `centre`; 0
/// for a point at the centre. Vectorised.
void point_waves(double k, const PointArrays& points, std::size_t begin, Vec centre,
                 std::span<double> re, std::span<double> im);

}  // namespace flatspeckle::wave
