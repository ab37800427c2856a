#include "grin/media/scattering_medium.h"

#include <cmath>

#include "core/error.h"
#include "grin/media/start_directions.h"

namespace flatspeckle::grin {

namespace {

using std::numbers::pi;

/// The integral of 3/8 (1 + c^2) from -1 is u where c^3 + 3 c = 8 u - 4; Cardano.
double rayleigh_cosine(double u) {
  const double half = 4 * u - 2;
  const double root = std::cbrt(half + std::sqrt(half * half + 1));
  return root - 1 / root;
}

}  // namespace

double SpacePhaseFunction::density(double cosine) const {
  switch (kind) {
    case Kind::henyey_greenstein:
      return HenyeyGreenstein<3>{g}.density_at(cosine);
    case Kind::rayleigh:
      return 3 / (16 * pi) * (1 + cosine * cosine);
    default:
      return Isotropic<3>::value;
  }
}

Vec3 SpacePhaseFunction::sample(const Vec3& direction, RandomStream& random) const {
  const double u = random.uniform();
  switch (kind) {
    case Kind::henyey_greenstein:
      return random_turn(direction, HenyeyGreenstein<3>{g}.sample_one_minus_cosine(u), random);
    case Kind::rayleigh:
      return random_turn(direction, 1 - rayleigh_cosine(u), random);
    default:
      return random_turn(direction, 2 * u, random);
  }
}

void check(const ScatteringMedium& medium, const std::string& prefix) {
  const auto not_negative = [&](const char* key, double value) {
    if (!(value >= 0) || !std::isfinite(value))
      throw InputError(prefix + key, value, "must be finite and not negative");
  };
  not_negative("mu_s", medium.mu_s);
  not_negative("mu_a", medium.mu_a);
  if (!(std::abs(medium.phase.g) < 1))
    throw InputError(prefix + "g", medium.phase.g, "must be in (-1, 1)");
}

}  // namespace flatspeckle::grin
