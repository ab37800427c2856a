#pragma once

#include <cmath>

#include "core/numbers/random.h"
#include "grin/media/geometry/vec3.h"

namespace flatspeckle::grin {

/// Distribution of the random start directions in the search for ray curves from P to Q. A fraction
/// chord_share of the directions is uniform in a cone about the chord, the straight line from P to
/// Q; the curves of weak fields start in this cone. The others are uniform over the sphere, so that
/// every curve can be sampled. The density per solid angle at the angle t from the chord is
///   chord_share [cos t > cos cone] / (2 pi (1 - cos cone)) + (1 - chord_share) / (4 pi).
/// The estimate of a sum over curves is unbiased for any cone and any chord_share < 1 (conventions,
/// C26). They only affect the number of trials.
struct StartDirections {
  double chord_share = 0.5;  ///< fraction of directions in the cone; in [0, 1)
  double cosine = 0.9;       ///< cosine of the cone's half angle

  /// Returns a random unit vector; the chord must be a unit vector too.
  Vec3 sample(const Vec3& chord, RandomStream& random) const;
  double density(double cos_from_chord) const;
};

/// Returns the direction with the given cosine to the axis, a unit vector, and the given azimuth.
Vec3 direction_about(const Vec3& axis, double cosine, double azimuth);

/// Renormalises a unit vector that has rounding errors, so that lengths do not drift in long walks.
inline Vec3 unit_again(const Vec3& v) {
  return (1.5 - 0.5 * v.squaredNorm()) * v;
}

/// Returns the direction with a given 1 - cosine to the axis, a unit vector, and a random azimuth.
/// The azimuth is taken from a random point in a disk, which avoids trigonometric functions.
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
  // Builds an orthonormal basis without branches [duff2017].
  const double sign = std::copysign(1.0, axis[2]), c = -1 / (sign + axis[2]);
  const double t = sign * axis[0] * a + axis[1] * b;
  return unit_again((1 - one_minus_cosine) * axis +
                    Vec3(a + axis[0] * c * t, sign * b + axis[1] * c * t, -t));
}

}  // namespace flatspeckle::grin
