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

/// A point on the unit circle.
struct CirclePoint {
  double cosine, sine;
};
/// Returns the point at the azimuth 2 pi (u - 1/2), for u in (0, 1). The sine of half the azimuth
/// is computed by its Taylor series. The azimuth is exact to 1e-15, near +-pi to 1e-8.
inline CirclePoint circle_point(double u) {
  constexpr double coefficients[] = {
      3.1415926535897932,    -5.1677127800499700,    2.5501640398773454,    -5.9926452932079208e-1,
      8.2145886611128228e-2, -7.3704309457143504e-3, 4.6630280576761257e-4, -2.1915353447830216e-5,
      7.9520540014755127e-7, -2.2948428997269874e-8, 5.3926646662608131e-10};
  const double t = u - 0.5, square = t * t;
  double sum = 0;
  for (int i = 10; i >= 0; --i) sum = sum * square + coefficients[i];
  const double sine = sum * t, cosine = std::sqrt(1 - sine * sine);
  return {1 - 2 * sine * sine, 2 * sine * cosine};
}

/// Returns the direction with a given 1 - cosine to the axis, a unit vector, and a random azimuth.
inline Vec3 random_turn(const Vec3& axis, double one_minus_cosine, RandomStream& random) {
  const auto [cosine, sine] = circle_point(random.uniform());
  const double across = std::sqrt(one_minus_cosine * (2 - one_minus_cosine));
  const double a = across * cosine, b = across * sine;
  // Builds an orthonormal basis without branches [duff2017].
  const double sign = std::copysign(1.0, axis[2]), c = -1 / (sign + axis[2]);
  const double t = sign * axis[0] * a + axis[1] * b;
  return unit_again((1 - one_minus_cosine) * axis +
                    Vec3(a + axis[0] * c * t, sign * b + axis[1] * c * t, -t));
}

}  // namespace flatspeckle::grin
