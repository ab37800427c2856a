#pragma once

#include <cmath>

#include "core/numbers/random.h"
#include "grin/media/geometry/vec3.h"

namespace flatspeckle::grin {

/// Where the trials of a connection start. A share of them is uniform in a cone about the chord,
/// where the curve of a weak field lies; the rest is uniform over the sphere, so that every curve
/// has a chance. The density per solid angle at angle t from the chord is
///   chord_share [cos t > cos cone] / (2 pi (1 - cos cone)) + (1 - chord_share) / (4 pi).
/// The estimate of a sum over curves is unbiased for any values with chord_share < 1
/// (conventions, C26); they only set how many trials it takes.
struct StartDirections {
  double chord_share = 0.5;  ///< in [0, 1)
  double cosine = 0.9;       ///< of the cone's half angle

  /// A unit vector; the chord must be one too.
  Vec3 sample(const Vec3& chord, RandomStream& random) const;
  double density(double cos_from_chord) const;
};

/// At this cosine from the axis (a unit vector) and this azimuth.
Vec3 direction_about(const Vec3& axis, double cosine, double azimuth);

/// A unit vector but for rounding is one again: lengths of long walks do not drift.
inline Vec3 unit_again(const Vec3& v) {
  return (1.5 - 0.5 * v.squaredNorm()) * v;
}

/// At this 1 - cosine from the axis (a unit vector) and a random azimuth, without trigonometry:
/// the azimuth is that of a random point in a disk.
inline Vec3 random_turn(const Vec3& axis, double one_minus_cosine, RandomStream& random) {
  double a, b, square;
  do {
    a = 2 * random.uniform() - 1;
    b = 2 * random.uniform() - 1;
    square = a * a + b * b;
  } while (square > 1);
  const double sine = std::sqrt(one_minus_cosine * (2 - one_minus_cosine) / square);
  a *= sine;
  b *= sine;
  // Duff et al. 2017, Building an orthonormal basis, revisited
  const double sign = std::copysign(1.0, axis[2]), c = -1 / (sign + axis[2]);
  const double t = sign * axis[0] * a + axis[1] * b;
  return unit_again((1 - one_minus_cosine) * axis +
                    Vec3(a + axis[0] * c * t, sign * b + axis[1] * c * t, -t));
}

}  // namespace flatspeckle::grin
